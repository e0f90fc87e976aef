// SPDX-License-Identifier: Apache-2.0
//
// Colours of distances: those of the server, so that JPEG and lossless pictures look alike. TURBO has 256 x RGB, near = warm, far = cold;
// black = rejected. "disparity" is linear in the disparity between d(far) and d(near), "depth" is linear in metres.

import { imageOf } from './images.js'
import { TURBO } from './turbo.js'

const BLACK = 0xff000000
const step = t => Math.min(255, Math.max(0, Math.round(t * 255)))
const turboPixel = t => {
  const i = 3 * step(t)
  return (BLACK | TURBO[i + 2] << 16 | TURBO[i + 1] << 8 | TURBO[i]) >>> 0
}
const greyPixel = t => (BLACK | step(t) * 0x010101) >>> 0

/** A colour 0 (far) .. 1 (near) for canvas and CSS. */
export function turbo(t) {
  const i = 3 * step(t)
  return `rgb(${TURBO[i]} ${TURBO[i + 1]} ${TURBO[i + 2]})`
}

/** Focal length times baseline, m px; 0 where one of them is unknown. */
export function metresTimesPixels(geometry) {
  return geometry ? geometry.f * geometry.baseline_mm / 1000 : 0
}

export function disparityOf(metres, geometry) {
  return metresTimesPixels(geometry) / metres - geometry.disparity_offset
}

/** Metres of a disparity in px; null where no calibration says it or it lies at infinity. */
export function depthOf(disparity, geometry) {
  const shifted = disparity + geometry.disparity_offset
  const k = metresTimesPixels(geometry)
  return k > 0 && shifted > 0 ? k / shifted : null
}

/** Distances that the disparities can show, [nearest, farthest] in m; null without a calibration. */
export function measurable(geometry) {
  if (!(metresTimesPixels(geometry) > 0)) return null
  const nearest = depthOf(geometry.d_min + geometry.disparities - 1, geometry)
  // Less than a pixel is too little to tell one distance from another.
  const farthest = depthOf(Math.max(geometry.d_min, 1 - geometry.disparity_offset), geometry)
  return nearest && farthest > nearest ? [nearest, Math.min(farthest, 65.5)] : null
}

/** The range of an image of a frame's header in m, far = Infinity where it has no end; null without a calibration. */
export function rangeOf(image) {
  return image?.range_m ? [image.range_m[0], image.range_m[1] ?? Infinity] : null
}

/** Where a distance lies in the colours of an image: 1 = near end, 0 = far end; beyond them it is outside 0 .. 1. */
export function placeOf(metres, image, range, geometry) {
  const [near, far] = range
  if (image !== 'disparity') return (far - metres) / (far - near)
  const dFar = disparityOf(far, geometry)
  return (disparityOf(metres, geometry) - dFar) / (disparityOf(near, geometry) - dFar)
}

/** How the raw values of an image become colours: a table of 65536 pixels (ABGR), by the value's 16 bits. */
function tableOf(image, header) {
  const table = new Uint32Array(65536)
  let [low, high] = image.range ?? [0, 255]
  if (!(high > low)) high = low + 1
  const share = value => (value - low) / (high - low)
  for (let bits = 0; bits < 65536; ++bits) {
    const signed = image.type === 'i16' && bits > 32767 ? bits - 65536 : bits
    if (image.name === 'disparity') table[bits] = signed === header.invalid ? BLACK : turboPixel(share(signed))
    else if (image.name === 'depth') table[bits] = bits === 0 ? BLACK : turboPixel(1 - share(bits))
    else if (imageOf(image.name).view === 'spread') table[bits] = bits === 0 ? BLACK : turboPixel(share(bits))
    else table[bits] = greyPixel(share(bits))
  }
  return table
}

const tables = new Map() // name -> { key, table }: a range changes seldom, a frame comes often

/** Colours raw values. Returns an ImageData of the image's size. */
export function colourRaw(image, raw, header) {
  const data = new ImageData(image.width, image.height)
  const out = new Uint32Array(data.data.buffer)
  if (image.type === 'bgr8') {
    for (let i = 0, j = 0; i < out.length; ++i, j += 3) out[i] = BLACK | raw[j] << 16 | raw[j + 1] << 8 | raw[j + 2]
    // BGR puts blue first, and so does a pixel ABGR read from its high end.
    return data
  }
  const key = JSON.stringify([image.range, image.type, header.invalid])
  let known = tables.get(image.name)
  if (known?.key !== key) {
    known = { key, table: tableOf(image, header) }
    tables.set(image.name, known)
  }
  const bits = image.type === 'i16' ? new Uint16Array(raw.buffer, raw.byteOffset, raw.length) : raw
  for (let i = 0; i < out.length; ++i) out[i] = known.table[bits[i]]
  return data
}
