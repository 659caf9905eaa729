"use strict";
// Unpacks what the program packed (experiments/src/page/encoding). Nothing is fetched.

/** Decoder of an adaptive binary range coder (encoding/coder.rs). A model is the probability of a zero, of 2048. */
class Decoder {
  /** @param {string} text base64 */
  constructor(text) {
    this.bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    [this.at, this.code, this.range] = [0, 0, 0xffffffff];
    for (let k = 0; k < 5; k++) this.code = ((this.code << 8) | this.next()) >>> 0;
  }

  next() { return this.at < this.bytes.length ? this.bytes[this.at++] : 0; }

  /** @param {Uint16Array} models @param {number} index @returns {number} 0 or 1 */
  bit(models, index) {
    const model = models[index];
    const bound = (this.range >>> 11) * model;
    let bit = 0;
    if (this.code < bound) {
      this.range = bound;
      models[index] = model + ((2048 - model) >> 5);
    } else {
      this.code -= bound;
      this.range -= bound;
      models[index] = model - (model >> 5);
      bit = 1;
    }
    while (this.range < 0x1000000) {
      this.range = (this.range << 8) >>> 0;
      this.code = ((this.code << 8) | this.next()) >>> 0;
    }
    return bit;
  }

  /** An Elias gamma code: its length, then its bits. @param {Uint16Array} longer @param {number} from @param {Uint16Array} bits
   * @param {number} most @returns {[number, number]} the number and its length */
  gamma(longer, from, bits, most) {
    let length = 0;
    while (length + 1 < most && this.bit(longer, from + length)) length++;
    let found = 1;
    for (let place = length - 1; place >= 0; place--) found = (found << 1) | this.bit(bits, length * most + place);
    return [found, length];
  }
}

/** @param {number} count @returns {Uint16Array} */
const models = (count) => new Uint16Array(count).fill(1024);

/** Signed numbers (encoding/number.rs). */
class Numbers {
  constructor() {
    const length = 24, contexts = 9;
    Object.assign(this, { length, contexts, zero: models(contexts), negative: models(contexts), former: 0 });
    [this.longer, this.bits] = [models(length * contexts), models(length * length)];
  }

  /** @param {Decoder} decoder @returns {number} */
  next(decoder) {
    const context = Math.min(this.former, this.contexts - 1);
    this.former = 0;
    if (decoder.bit(this.zero, context)) return 0;
    const negative = decoder.bit(this.negative, context);
    const [size, length] = decoder.gamma(this.longer, context * this.length, this.bits, this.length);
    this.former = length + 1;
    return negative ? -size : size;
  }
}

/** Numbers that may be missing, as differences (encoding/number.rs). */
class Series {
  constructor() { Object.assign(this, { missing: models(2), differences: new Numbers(), wasMissing: 0, former: 0 }); }

  /** @param {Decoder} decoder @returns {number|null} */
  next(decoder) {
    this.wasMissing = decoder.bit(this.missing, this.wasMissing);
    if (this.wasMissing) return null;
    this.former += this.differences.next(decoder);
    return this.former;
  }
}

/** @param {string} text @param {number} count @param {number} step @returns {(number|null)[]} */
function series(text, count, step) {
  const [decoder, numbers] = [new Decoder(text), new Series()];
  return Array.from({ length: count }, () => {
    const value = numbers.next(decoder);
    return value === null ? null : value * step;
  });
}

/**
 * Rasters of bytes (encoding/film.rs).
 * @param {string} text @param {number} count @param {{width: number, cells: number, values: number, start: number}} shape
 * @returns {Uint8Array[]}
 */
function film(text, count, { width, cells, values, start }) {
  const ZONES = 8, LENGTH = 8;
  const decoder = new Decoder(text), bounds = new Numbers();
  const [changes, downs, longer, bits] = [16 * ZONES, 3 * ZONES, 2 * LENGTH, LENGTH * LENGTH].map(models);
  const cell = new Uint8Array(cells).fill(start), last = new Uint8Array(cells);
  let [now, before] = [new Uint8Array(cells), new Uint8Array(cells)];
  const all = [];
  for (let k = 0; k < count; k++) {
    [now, before] = [before.fill(0), now];
    const [left, right, bottom, top] = [0, 1, 2, 3].map(() => bounds.next(decoder));
    for (let row = bottom; row < top; row++) {
      for (let column = left; column < right; column++) {
        const at = row * width + column;
        const was = cell[at];
        const zone = Math.floor((was * ZONES) / values);
        const beside = column > 0 ? now[at - 1] : 0;
        const below = row > 0 ? now[at - width] : 0;
        const side = row > 0 && column + 1 < width ? now[at - width + 1] : 0;
        if (!decoder.bit(changes, (8 * beside + 4 * below + 2 * side + before[at]) * ZONES + zone)) continue;
        const down = decoder.bit(downs, zone * 3 + last[at]);
        [now[at], last[at]] = [1, 1 + down];
        const [size] = decoder.gamma(longer, down * LENGTH, bits, LENGTH);
        cell[at] = down ? was - size : was + size;
      }
    }
    all.push(cell.slice());
  }
  return all;
}
