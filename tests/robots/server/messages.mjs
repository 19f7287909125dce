// Definitions of the messages that the test's robot speaks, in ROS 1 and ROS 2, and their bytes by
// Foxglove's own libraries.
// SPDX-License-Identifier: Apache-2.0
import rosmsg from "@foxglove/rosmsg";
import ros1 from "@foxglove/rosmsg-serialization";
import cdr from "@foxglove/rosmsg2-serialization";

const time = (ros2) => (ros2 ? "builtin_interfaces/Time" : "time");
const duration = (ros2) => (ros2 ? "builtin_interfaces/Duration" : "duration");

const types = {
  "std_msgs/Header": (r) => `${r ? "" : "uint32 seq\n"}${time(r)} stamp\nstring frame_id`,
  "std_msgs/String": () => "string data",
  "builtin_interfaces/Time": () => "int32 sec\nuint32 nanosec",
  "builtin_interfaces/Duration": () => "int32 sec\nuint32 nanosec",
  "unique_identifier_msgs/UUID": () => "uint8[16] uuid",
  "actionlib_msgs/GoalID": () => "time stamp\nstring id",
  "actionlib_msgs/GoalStatus": () => "actionlib_msgs/GoalID goal_id\nuint8 status\nstring text",
  "actionlib_msgs/GoalStatusArray": () =>
    "std_msgs/Header header\nactionlib_msgs/GoalStatus[] status_list",
  "sensor_msgs/JointState": () =>
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort",
  "sensor_msgs/Image": () =>
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n" +
    "uint32 step\nuint8[] data",
  "sensor_msgs/CompressedImage": () => "std_msgs/Header header\nstring format\nuint8[] data",
  "sensor_msgs/PointField": () => "string name\nuint32 offset\nuint8 datatype\nuint32 count",
  "sensor_msgs/PointCloud2": () =>
    "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n" +
    "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
  "sensor_msgs/LaserScan": () =>
    "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n" +
    "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n" +
    "float32[] ranges\nfloat32[] intensities",
  "sensor_msgs/RegionOfInterest": () =>
    "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify",
  "sensor_msgs/CameraInfo": (r) =>
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n" +
    (r ? "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\n"
       : "float64[] D\nfloat64[9] K\nfloat64[9] R\nfloat64[12] P\n") +
    "uint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi",
  "geometry_msgs/Vector3": () => "float64 x\nfloat64 y\nfloat64 z",
  "geometry_msgs/Point": () => "float64 x\nfloat64 y\nfloat64 z",
  "geometry_msgs/Quaternion": () => "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
  "geometry_msgs/Pose": () =>
    "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
  "geometry_msgs/PoseWithCovariance": () => "geometry_msgs/Pose pose\nfloat64[36] covariance",
  "geometry_msgs/Twist": () => "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
  "geometry_msgs/TwistWithCovariance": () => "geometry_msgs/Twist twist\nfloat64[36] covariance",
  "geometry_msgs/Transform": () =>
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
  "geometry_msgs/TransformStamped": () =>
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
  "tf2_msgs/TFMessage": () => "geometry_msgs/TransformStamped[] transforms",
  "nav_msgs/Odometry": () =>
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n" +
    "geometry_msgs/TwistWithCovariance twist",
  "sensor_msgs/Imu": () =>
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n" +
    "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n" +
    "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n" +
    "float64[9] linear_acceleration_covariance",
  "trajectory_msgs/JointTrajectoryPoint": (r) =>
    "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n" +
    `${duration(r)} time_from_start`,
  "trajectory_msgs/JointTrajectory": () =>
    "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points",
  "control_msgs/JointTolerance": () =>
    "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration",
  "control_msgs/FollowJointTrajectoryGoal": (r) =>
    "trajectory_msgs/JointTrajectory trajectory\ncontrol_msgs/JointTolerance[] path_tolerance\n" +
    `control_msgs/JointTolerance[] goal_tolerance\n${duration(r)} goal_time_tolerance`,
  "control_msgs/FollowJointTrajectoryResult": () => "int32 error_code\nstring error_string",
  "robot_calibration_msgs/GripperLedCommandGoal": () => "uint8 led_code",
  "robot_calibration_msgs/GripperLedCommandResult": () => "",
};
for (const action of ["control_msgs/FollowJointTrajectory", "robot_calibration_msgs/GripperLedCommand"]) {
  types[`${action}ActionGoal`] = () =>
    `std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n${action}Goal goal`;
  types[`${action}ActionResult`] = () =>
    `std_msgs/Header header\nactionlib_msgs/GoalStatus status\n${action}Result result`;
  // As bridges write them: the goal's and the result's fields beside those of the service.
  types[`${action}_SendGoal_Request`] = (r) =>
    `unique_identifier_msgs/UUID goal_id\n${types[action + "Goal"](r)}`;
  types[`${action}_SendGoal_Response`] = () => "bool accepted\nbuiltin_interfaces/Time stamp";
  types[`${action}_GetResult_Request`] = () => "unique_identifier_msgs/UUID goal_id";
  types[`${action}_GetResult_Response`] = (r) => `int8 status\n${types[action + "Result"](r)}`;
}

/** The text of a type and of all types that it uses. */
export function definition(type, ros2) {
  const all = [type];
  const texts = all.map((t) => types[t](ros2));
  for (let i = 0; i < texts.length; ++i) {
    for (const [, used] of texts[i].matchAll(/^(\w+\/\w+)/gm)) {
      if (all.includes(used)) continue;
      all.push(used);
      texts.push(types[used](ros2));
    }
  }
  return texts.map((t, i) => (i === 0 ? t : `MSG: ${all[i]}\n${t}`)).join(`\n${"=".repeat(80)}\n`);
}

export function writer(type, ros2) {
  const parsed = rosmsg.parse(definition(type, ros2), { ros2 });
  return ros2 ? new cdr.MessageWriter(parsed) : new ros1.MessageWriter(parsed);
}

export function reader(type, ros2) {
  const parsed = rosmsg.parse(definition(type, ros2), { ros2 });
  return ros2 ? new cdr.MessageReader(parsed) : new ros1.MessageReader(parsed);
}
