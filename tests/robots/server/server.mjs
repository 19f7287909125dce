// A Foxglove bridge with a simulated robot behind it, for tests; by the protocol's reference server.
//   node server.mjs '{"encoding": "ros1" | "cdr", "protocol": "foxglove.sdk.v1", "joint_type": ...,
//                     "rate": 5 (of the robot's clock), "die_after": 0.5 (seconds after a goal: see "goals"),
//                     "remote": true, "camera": "/head_camera", "urdf": TEXT (of a topic), "urdf_parameter": TEXT,
//                     "base": {} (see base.mjs)}'
// It prints {"port": ...} and then takes faults from its standard input, one a line: see `faults`; if it
// is remote, see remote.mjs.
// SPDX-License-Identifier: Apache-2.0
import { createInterface } from "node:readline";
import protocol from "@foxglove/ws-protocol";
import { WebSocketServer } from "ws";
import { Base } from "./base.mjs";
import { definition, reader, writer } from "./messages.mjs";
import { RemoteRobot, cameraOf, cloudOf } from "./remote.mjs";
import { Robot } from "./robot.mjs";

const { FoxgloveServer, ServerCapability } = protocol;
const options = { encoding: "ros1", ...JSON.parse(process.argv[2] ?? "{}") };
const ros2 = options.encoding === "cdr";
const input = createInterface({ input: process.stdin }).on("close", () => process.exit(0));
const robot = options.remote ? new RemoteRobot(input) : new Robot();
const server = new FoxgloveServer({
  name: "test", supportedEncodings: [options.encoding],
  capabilities: options.capabilities ?? [ServerCapability.clientPublish, ServerCapability.services],
});
const sockets = new Set();
const state = { silent: new Set(), imageLead: 0, refuse: false, abort: false, half: new Set(),
  withdrawn: new Set() };

const rate = options.rate ?? 1;
const began = Date.now() / 1000;
const seconds = () => (options.remote ? robot.now : began + rate * (Date.now() / 1000 - began));
const later = (time) => new Promise((end) => setTimeout(end, (time * 1000) / rate));
const fullType = (type, kind) => (ros2 ? type.replace("/", `/${kind}/`) : type);
function stamp(now) {
  const sec = Math.floor(now), ns = Math.floor((now - sec) * 1e9);
  return ros2 ? { sec, nanosec: ns } : { sec, nsec: ns };
}
const header = (now, frame = "") => ({ seq: 0, stamp: stamp(now), frame_id: frame });

// Topics: a function that sends a message on each.
const topics = new Map();
function topic(name, type, advertised = type) {
  const write = writer(type, ros2);
  const add = () => server.addChannel({
    topic: name, encoding: options.topic_encoding ?? options.encoding,
    schemaName: fullType(advertised, "msg"), schema: definition(advertised, ros2),
    schemaEncoding: ros2 ? "ros2msg" : "ros1msg",
  });
  let channel = add();
  const send = (message) => {
    if (state.silent.has(name) || state.withdrawn.has(name)) return;
    const bytes = write.writeMessage(message);
    const sent = state.half.has(name) ? bytes.subarray(0, bytes.length >> 1) : bytes;
    server.sendMessage(channel, BigInt(Date.now()) * 1000000n, sent);
  };
  send.withdraw = () => server.removeChannel(channel);
  send.again = () => {
    send.withdraw();
    channel = add();
  };
  topics.set(name, send);
  return send;
}

const joints = topic("/joint_states", "sensor_msgs/JointState", options.joint_type);
const camera = options.camera ?? "/camera";
const image = topic(`${camera}/image`, "sensor_msgs/Image");
const cloud = topic(`${camera}/points`, "sensor_msgs/PointCloud2");
const scan = topic("/base_scan", "sensor_msgs/LaserScan");
const compressedImage = topic(`${camera}/image/compressed`, "sensor_msgs/CompressedImage");
const depth = topic(`${camera}/depth`, "sensor_msgs/Image");
const compressedDepth = topic(`${camera}/depth/compressedDepth`, "sensor_msgs/CompressedImage");
const info = topic(`${camera}/camera_info`, "sensor_msgs/CameraInfo");

// The URDF, for whoever subscribes; or the parameter.
if (options.urdf !== undefined) {
  const description = topic("/robot_description", "std_msgs/String");
  server.on("subscribe", () => description({ data: options.urdf }));
}
server.on("getParameters", ({ id }, connection) => {
  const value = options.urdf_parameter;
  const found = value === undefined ? [] : [{ name: "/robot_description", value }];
  server.publishParameterValues(found, id, connection);
});

function stream() {
  const now = seconds();
  joints({ header: header(now), ...robot.joints(["shoulder", "elbow"], now) });
  joints({ header: header(now), ...robot.joints(["head"], now) });  // another node
}
function look() {
  const now = seconds();
  const at = header(now + state.imageLead, "camera_optical_frame");
  image({ header: at, ...robot.image(now) });
  cloud({ header: at, ...robot.cloud(now) });
  if (!base) scan({
    header: header(now, "laser_link"), angle_min: -0.5, angle_max: 0.5, angle_increment: 0.25, time_increment: 0.001,
    scan_time: 0.04, range_min: 0.1, range_max: 10, ranges: [1, NaN, 2, Infinity, 20], intensities: [],
  });
  compressedImage({ header: at, ...robot.compressedImage(now) });
  depth({ header: at, ...robot.depth() });
  compressedDepth({ header: at, ...robot.compressedDepth() });
  info({ header: at, ...robot.camera(ros2) });
}
function publishJoints(name, position, now) {
  joints({ header: header(now), name, position, velocity: [], effort: [] });
}
function publishView(view, now) {
  const at = header(now, view.frame);
  cloud({ header: at, ...cloudOf(view) });
  info({ header: at, ...cameraOf(view, ros2) });
}
if (options.remote) {
  const isBusy = () => sockets.size === 0 || [...sockets].some((s) => s.bufferedAmount > 1e6);
  robot.follow(publishJoints, publishView, isBusy);
} else {
  setInterval(stream, 10);
  setInterval(look, 40);
}

// Actions: what they do with a goal; they end when they have done it.
const actions = new Map();
let goals = 0;
function trajectory(goal) {
  if (++goals === options.goals) setTimeout(die, 1000 * options.die_after);
  const { joint_names: names, points } = goal.trajectory;
  const t = points[0].time_from_start;
  const time = t.sec + (t.nsec ?? t.nanosec) * 1e-9;
  return robot.move(names, points[0].positions, seconds(), time) ?? later(time);
}
function leds(goal) {
  return robot.light(goal.led_code) ?? later(0);
}
const failed = { error_code: -4, error_string: "path tolerance violated" };
const followed = () => (state.abort ? failed : { error_code: 0, error_string: "" });

function ros1Action(name, type, run, result) {
  const goals = new Map();
  const sendStatus = topic(`${name}/status`, "actionlib_msgs/GoalStatusArray");
  const sendResult = topic(`${name}/result`, `${type}ActionResult`);
  const publish = () =>
    sendStatus({ header: header(seconds()), status_list: [...goals.values()] });
  const finish = (status) => {
    status.status = state.abort ? 4 : 3;
    sendResult({ header: header(seconds()), status, result: result() });
  };
  setInterval(publish, 100);
  const read = reader(`${type}ActionGoal`, false);
  actions.set(`${name}/goal`, (data) => {
    const message = read.readMessage(data);
    if (goals.has(message.goal_id.id)) return;
    const status = { goal_id: message.goal_id, status: state.refuse ? 5 : 1, text: "" };
    if (state.refuse) status.text = "joint limits";
    goals.set(message.goal_id.id, status);
    publish();
    if (state.refuse) return;
    (state.abort ? later(0.1) : run(message.goal)).then(() => finish(status));
  });
}

function ros2Action(name, type, run, result) {
  const goals = new Map();
  const service = (suffix, part, answer) => {
    const request = reader(`${type}_${part}_Request`, true);
    const response = writer(`${type}_${part}_Response`, true);
    const schema = (kind) => ({
      encoding: "cdr", schemaName: fullType(`${type}_${part}_${kind}`, "action"),
      schemaEncoding: "ros2msg", schema: definition(`${type}_${part}_${kind}`, true),
    });
    const full = { name: `${name}/_action/${suffix}`, type: fullType(`${type}_${part}`, "action") };
    const text = { requestSchema: "", responseSchema: "" };
    const parts = { request: schema("Request"), response: schema("Response") };
    const id = server.addService({ ...full, ...(options.old_services ? text : parts) });
    actions.set(id, async (data) => response.writeMessage(await answer(request.readMessage(data))));
  };
  service("send_goal", "SendGoal", (goal) => {
    const accepted = !state.refuse;
    const done = !accepted || state.abort ? later(0.1) : run(goal);
    goals.set(goal.goal_id.uuid.join(), done);
    return { accepted, stamp: stamp(seconds()) };
  });
  service("get_result", "GetResult", async ({ goal_id: id }) => {
    await goals.get(id.uuid.join());
    return { status: state.abort ? 6 : 4, ...result() };
  });
}

const action = ros2 ? ros2Action : ros1Action;
if (!options.hidden) {
  const type = "control_msgs/FollowJointTrajectory";
  action("/arm_controller/follow_joint_trajectory", type, trajectory, followed);
  action("/head_controller/follow_joint_trajectory", type, trajectory, followed);
  action("/gripper_controller/led_action", "robot_calibration_msgs/GripperLedCommand", leds, () => ({}));
}

let base;
if (options.base) {
  base = new Base(options.base, seconds());
  const odom = topic("/odom", "nav_msgs/Odometry");
  const imu = topic("/imu", "sensor_msgs/Imu");
  const frames = topic("/tf_static", "tf2_msgs/TFMessage");
  server.on("subscribe", () => frames({ transforms: base.mounts(header(seconds(), "base_link")) }));
  const read = reader("geometry_msgs/Twist", ros2);
  actions.set("/cmd_vel", (data) => base.command(read.readMessage(data), seconds()));
  setInterval(() => {
    const now = seconds();
    base.step(now);
    odom({ header: header(now, "odom"), ...base.odometry() });
    imu({ header: header(now, "imu_link"), ...base.imu() });
    scan({ header: header(now, "laser_link"), ...base.scan() });
  }, 20);
}

// ROS loses what is published before subscribers have heard of the publisher.
const advertised = new Map();
server.on("advertise", (channel) => advertised.set(channel.topic, Date.now()));
server.on("message", ({ channel, data }) => {
  if (Date.now() - advertised.get(channel.topic) > 100) actions.get(channel.topic)?.(data);
});
server.on("serviceCallRequest", async ({ serviceId, callId, encoding, data }, connection) => {
  try {
    const bytes = await actions.get(serviceId)(data);
    server.sendServiceCallResponse({ serviceId, callId, encoding, data: bytes }, connection);
  } catch (error) {
    const failure = { op: "serviceCallFailure", serviceId, callId, message: String(error) };
    server.sendServiceCallFailure(failure, connection);
  }
});
server.on("error", () => {});

const faults = {
  text: ({ text }) => sockets.forEach((s) => s.send(text)),
  binary: ({ bytes }) => sockets.forEach((s) => s.send(Buffer.from(bytes))),
  // The header of a frame of 2 GB, without the frame.
  big: () => sockets.forEach((s) => s._socket.write(Buffer.from([0x82, 127, 0, 0, 0, 0, 128, 0, 0, 0]))),
  raw: ({ bytes }) => sockets.forEach((s) => s._socket.write(Buffer.from(bytes))),
  close: () => sockets.forEach((s) => s.close()),
  cut: () => sockets.forEach((s) => s._socket.destroy()),
  die: () => die(),
  again: () => joints.again(),
  status: ({ message }) => server.sendStatus({ level: 2, message }),
  set: ({ values }) => Object.assign(state, values),
  silent: ({ topics }) => (state.silent = new Set(topics)),
  withdraw: ({ topic: name }) => {
    state.withdrawn.add(name);
    topics.get(name).withdraw();
  },
  half: ({ topics }) => (state.half = new Set(topics)),
  commands: () => base.commands,
  base: ({ values }) => void Object.assign(base, values),
};
function makeFault(line) {
  const fault = JSON.parse(line);
  console.log(JSON.stringify(faults[fault.fault](fault) ?? {}));
}
if (!options.remote) input.on("line", makeFault);

const die = () => process.kill(process.pid, "SIGKILL");

const sockets_server = new WebSocketServer({
  host: "127.0.0.1", port: 0,
  handleProtocols: (offered) =>
    options.protocol === undefined ? server.handleProtocols(offered)
      : offered.has(options.protocol) ? options.protocol : false,
});
sockets_server.on("connection", (socket) => {
  sockets.add(socket);
  
  socket.on("close", () => sockets.delete(socket));
  socket.on("error", () => {});
  if (options.mute) return;
  server.handleConnection(socket, "client");
});
sockets_server.on("listening", () => console.log(JSON.stringify(sockets_server.address())));
