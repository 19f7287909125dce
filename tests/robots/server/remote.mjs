// A robot that is simulated by whoever started the server.  It is asked over the standard output, one
// JSON object a line, as the programs of io/bridge/pipe_robot.hpp are, and answers over the standard input.
// Its clock runs as fast as its messages are taken.
// SPDX-License-Identifier: Apache-2.0

export class RemoteRobot {
  now = 0;        // seconds of its clock: stamp of the newest joint states
  #asked = [];    // who waits for answers, in their order
  #awaited = [];  // [condition on joint states, who waits for it]

  constructor(lines) {
    lines.on("line", (line) => this.#asked.shift()(JSON.parse(line)));
  }

  /** Publishes joint states and views, each with its stamp in seconds, for ever. */
  async follow(publishJoints, publishView, isBusy) {
    let jointsAfter = 0, viewAfter = 0;
    for (;;) {
      while (isBusy()) await new Promise((end) => setTimeout(end, 1));
      const view = await this.#ask({ view: { after: viewAfter } });
      viewAfter = view.stamp;
      while (jointsAfter < view.stamp) {
        const joints = await this.#ask({ joints: { after: jointsAfter } });
        jointsAfter = joints.stamp;
        this.now = joints.stamp * 1e-9;
        publishJoints(joints.names, joints.positions, this.now);
        this.#awaited = this.#awaited.filter(([isTrue, end]) => !isTrue(joints) || end());
      }
      publishView(view, view.stamp * 1e-9);
    }
  }

  /** Ends when the joints are there. */
  async move(names, positions) {
    await this.#ask({ move: { names, positions: [...positions] } });
    const is = ({ names: all, positions: now }, i) => now[all.indexOf(names[i])];
    await this.#until((joints) => names.every((_, i) => Math.abs(is(joints, i) - positions[i]) < 0.02));
  }

  /** Ends when the LEDs are lit. */
  async light(code) {
    const { stamp } = await this.#ask({ light: code });
    await this.#until((joints) => joints.stamp >= stamp);
  }

  #ask(request) {
    return new Promise((answered) => {
      this.#asked.push(answered);
      console.log(JSON.stringify(request));
    });
  }

  #until(isTrue) {
    return new Promise((end) => this.#awaited.push([isTrue, end]));
  }
}

/** Fields of a PointCloud2 with colour, from a view of the robot. */
export function cloudOf({ width, height, points }) {
  const fields = ["x", "y", "z", "rgb"].map((name, i) => ({
    name, offset: 4 * i, datatype: 7, count: 1,
  }));
  const data = Buffer.from(points, "base64");
  return {
    height, width, fields, is_bigendian: false, point_step: 16, row_step: 16 * width, data,
    is_dense: false,
  };
}

/** Fields of its CameraInfo. */
export function cameraOf({ width, height, k, p }, ros2) {
  const d = [0, 0, 0, 0, 0], r = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const matrices = ros2 ? { d, k, r, p } : { D: d, K: k, R: r, P: p };
  const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
  return { height, width, distortion_model: "plumb_bob", ...matrices, binning_x: 0, binning_y: 0, roi };
}
