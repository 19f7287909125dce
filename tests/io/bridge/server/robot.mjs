// A robot that is simulated: joints that move linearly to their goal, LEDs, and what a camera sees.
// SPDX-License-Identifier: Apache-2.0

export const width = 32;
export const height = 24;

export class Robot {
  constructor() {
    this.motions = new Map(
      ["shoulder", "elbow", "head"].map((name) => [name, { from: 0, to: 0, start: 0, time: 1 }]),
    );
    this.ledCode = 0;
  }

  position(name, now) {
    const { from, to, start, time } = this.motions.get(name);
    return from + (to - from) * Math.min(Math.max((now - start) / time, 0), 1);
  }

  move(names, positions, now, time) {
    names.forEach((name, i) => {
      const from = this.position(name, now);
      this.motions.set(name, { from, to: positions[i], start: now, time: Math.max(time, 1e-3) });
    });
  }

  joints(names, now) {
    return { name: names, position: names.map((n) => this.position(n, now)), velocity: [], effort: [] };
  }

  /** Brighter to the right, with the head's motion; the first pixel shows the code of the LEDs. */
  pixels(now) {
    const shift = 10 * this.position("head", now);
    const data = new Uint8Array(width * height);
    data.forEach((_, i) => (data[i] = 100 + (i % width) + shift));
    data[0] = this.ledCode;
    return data;
  }

  image(now) {
    return { height, width, encoding: "mono8", is_bigendian: 0, step: width, data: this.pixels(now) };
  }

  /** A wall at 2 m, with a hole in the first pixel. */
  cloud(now) {
    const step = 16;
    const bytes = new DataView(new ArrayBuffer(width * height * step));
    this.pixels(now).forEach((gray, i) => {
      const z = i === 0 ? NaN : 2;
      bytes.setFloat32(i * step, ((i % width) - 16) * 0.1, true);
      bytes.setFloat32(i * step + 4, (Math.floor(i / width) - 12) * 0.1, true);
      bytes.setFloat32(i * step + 8, z, true);
      bytes.setUint32(i * step + 12, (gray << 16) | (gray << 8) | gray, true);
    });
    const fields = ["x", "y", "z", "rgb"].map((name, i) => ({
      name, offset: 4 * i, datatype: 7, count: 1,
    }));
    return {
      height, width, fields, is_bigendian: false, point_step: step, row_step: step * width,
      data: new Uint8Array(bytes.buffer), is_dense: false,
    };
  }

  camera(ros2) {
    const d = [0, 0, 0, 0, 0], k = [20, 0, 16, 0, 20, 12, 0, 0, 1], r = [1, 0, 0, 0, 1, 0, 0, 0, 1];
    const p = [20, 0, 16, 0, 0, 20, 12, 0, 0, 0, 1, 0];
    const matrices = ros2 ? { d, k, r, p } : { D: d, K: k, R: r, P: p };
    const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
    return { height, width, distortion_model: "plumb_bob", ...matrices, binning_x: 0, binning_y: 0, roi };
  }
}
