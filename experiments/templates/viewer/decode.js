"use strict";
// Unpacks what the program packed (experiments/src/report/encoding.rs). Nothing is fetched.

/**
 * @typedef {{scans: number, time_s: number, pose: number[]}} Moment
 * @typedef {{name: string, label: string, moment: number}} Stage
 * @typedef {{name: string, moments: number[], occupancy: string, scores: Object<string, (number|null)[]>[]}} Mapper
 * @typedef {{name: string, seed: number, cell_m: number, origin_m: number[], width: number, height: number, prior: number,
 *   radius_m: number, scans: number, route: number[][], moments: Moment[], stages: Stage[],
 *   regions: {name: string, cells: string}[], truth: string, looks: string, parts: string,
 *   metrics: string[][], mappers: Mapper[]}} World
 * @typedef {{truth: Uint8Array, looks: Uint32Array[], parts: Uint8Array[], regions: Map<string, Uint8Array>}} Ground
 */

/** Truth of a cell. */
const FREE = 0, OCCUPIED = 1, UNKNOWN = 2;

/** Names of the parts of a map, as coded: 0 is no part. */
const PARTS = ["", "visible", "surface", "shell", "hidden"];

/** @param {string} text base64 of zlib @returns {Promise<Uint8Array>} */
async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * One array per frame. Every frame is stored as its difference from the one before, low bytes first.
 * @template {Uint8Array|Int16Array|Uint32Array} T
 * @param {string} text @param {number} cells @param {{new(length: number): T, BYTES_PER_ELEMENT: number}} Kind
 * @returns {Promise<T[]>}
 */
async function frames(text, cells, Kind) {
  const bytes = await inflate(text);
  const size = Kind.BYTES_PER_ELEMENT;
  const all = [];
  for (let at = 0; at < bytes.length; at += size * cells) {
    const frame = new Kind(cells);
    const former = all.at(-1);
    for (let cell = 0; cell < cells; cell++) {
      let change = 0;
      for (let plane = 0; plane < size; plane++) change |= bytes[at + plane * cells + cell] << (8 * plane);
      frame[cell] = former ? former[cell] + change : change;
    }
    all.push(frame);
  }
  return all;
}

/** @param {World} world @returns {Promise<Ground>} */
async function unpackGround(world) {
  const cells = world.width * world.height;
  const regions = new Map();
  for (const region of world.regions) regions.set(region.name, (await frames(region.cells, cells, Uint8Array))[0]);
  return {
    truth: (await frames(world.truth, cells, Uint8Array))[0],
    looks: await frames(world.looks, cells, Uint32Array),
    parts: await frames(world.parts, cells, Uint8Array),
    regions,
  };
}

/** Keeps what was unpacked, so that every block is unpacked once. @type {Map<object, Promise<any>>} */
const unpacked = new Map();

/** @param {World} world @returns {Promise<Ground>} */
function groundOf(world) {
  if (!unpacked.has(world)) unpacked.set(world, unpackGround(world));
  return unpacked.get(world);
}

/** Log odds of every frame of a mapper. @param {World} world @param {Mapper} mapper @returns {Promise<Int16Array[]>} */
function mapsOf(world, mapper) {
  if (!unpacked.has(mapper)) unpacked.set(mapper, frames(mapper.occupancy, world.width * world.height, Int16Array));
  return unpacked.get(mapper);
}
