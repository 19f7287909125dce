// A mobile base that is simulated: it follows velocities at once, stops without them, and sees a wall.
// SPDX-License-Identifier: Apache-2.0

export class Base {
  /** wall: where it is ahead, metres; mount: direction of the scanner's x axis, radians, or null: not known; turns: odometry over truth; timeout: of commands, seconds; stuck: it does not move */
  constructor(options, now) {
    Object.assign(this, { wall: 3, mount: 0, turns: 1, timeout: 0.25, stuck: false, ...options });
    Object.assign(this, { x: 0, y: 0, yaw: 0, ahead: 0, turn: 0, now, commanded: now, commands: [] });
  }

  command({ linear, angular }, now) {
    this.step(now);
    this.commands.push([linear.x, angular.z]);
    [this.ahead, this.turn, this.commanded] = this.stuck ? [0, 0, now] : [linear.x, angular.z, now];
  }

  step(now) {
    if (now - this.commanded > this.timeout) this.ahead = this.turn = 0;
    const time = now - this.now;
    const middle = this.yaw + 0.5 * this.turn * time;
    this.x += this.ahead * time * Math.cos(middle);
    this.y += this.ahead * time * Math.sin(middle);
    this.yaw += this.turn * time;
    this.now = now;
  }

  odometry() {
    const yaw = this.turns * this.yaw;
    const orientation = { x: 0, y: 0, z: Math.sin(0.5 * yaw), w: Math.cos(0.5 * yaw) };
    const zero = { x: 0, y: 0, z: 0 }, covariance = Array(36).fill(0);
    return {
      child_frame_id: "base_link",
      pose: { pose: { position: { x: this.x, y: this.y, z: 0 }, orientation }, covariance },
      twist: { twist: { linear: zero, angular: { x: 0, y: 0, z: this.turn } }, covariance },
    };
  }

  imu() {
    const zero = { x: 0, y: 0, z: 0 }, covariance = Array(9).fill(0);
    return {
      orientation: { ...zero, w: 1 }, orientation_covariance: covariance,
      angular_velocity: { x: 0, y: 0, z: this.turn }, angular_velocity_covariance: covariance,
      linear_acceleration: zero, linear_acceleration_covariance: covariance,
    };
  }

  /** As transforms of /tf_static. */
  mounts(header) {
    if (this.mount === null) return [];
    const rotation = { x: 0, y: 0, z: Math.sin(0.5 * this.mount), w: Math.cos(0.5 * this.mount) };
    const translation = { x: 0.2, y: 0, z: 0.3 };
    return [{ header, child_frame_id: "laser_link", transform: { translation, rotation } }];
  }

  scan() {
    const ranges = [...Array(201).keys()].map((i) => {
      const ahead = Math.cos(this.yaw + (this.mount ?? 0) + 0.01 * (i - 100));
      return ahead > 0.05 ? (this.wall - this.x) / ahead : Infinity;
    });
    return {
      angle_min: -1, angle_max: 1, angle_increment: 0.01, time_increment: 0, scan_time: 0.02,
      range_min: 0.05, range_max: 30, ranges, intensities: [],
    };
  }
}
