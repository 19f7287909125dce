// A robot that is simulated: joints that move linearly to their goal, LEDs, and what a camera sees.
// SPDX-License-Identifier: Apache-2.0
import { crc32, deflateSync } from "node:zlib";

/** Gray PNG; rows of bytes, numbers of 16 bits with the upper byte first. */
function png(width, height, bits, rows) {
  const number = (n) => { const b = Buffer.alloc(4); b.writeUInt32BE(n); return b; };
  const chunk = (name, data) => {
    const named = Buffer.concat([Buffer.from(name), data]);
    return Buffer.concat([number(data.length), named, number(crc32(named))]);
  };
  const header = Buffer.concat([number(width), number(height), Buffer.from([bits, 0, 0, 0, 0])]);
  const data = deflateSync(Buffer.concat(rows.flatMap((row) => [Buffer.from([0]), row])));
  const chunks = [chunk("IHDR", header), chunk("IDAT", data), chunk("IEND", Buffer.alloc(0))];
  return Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"), ...chunks]);
}

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

  light(code) {
    this.ledCode = code;
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

  compressedImage(now) {
    const all = Buffer.from(this.pixels(now));
    const rows = [...Array(height).keys()].map((v) => all.subarray(v * width, (v + 1) * width));
    return { format: "png", data: png(width, height, 8, rows) };
  }

  /** A wall at 2 m, with a hole in the first pixel. */
  depth() {
    const data = Buffer.alloc(2 * width * height);
    for (let i = 1; i < width * height; ++i) data.writeUInt16LE(2000, 2 * i);
    return { height, width, encoding: "16UC1", is_bigendian: 0, step: 2 * width, data };
  }

  compressedDepth() {
    const all = this.depth().data.swap16();
    const step = 2 * width;
    const rows = [...Array(height).keys()].map((v) => all.subarray(v * step, (v + 1) * step));
    const data = Buffer.concat([Buffer.alloc(12), png(width, height, 16, rows)]);
    return { format: "16UC1; compressedDepth png", data };
  }

  /** A wall at 2 m, with a hole in the first pixel; the elbow moves it and makes it rough. */
  cloud(now) {
    const step = 16, elbow = this.position("elbow", now);
    const bytes = new DataView(new ArrayBuffer(width * height * step));
    this.pixels(now).forEach((gray, i) => {
      const z = i === 0 ? NaN : 2 - 0.1 * elbow + 0.002 * Math.sin(1000 * elbow * (i + 1));
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
