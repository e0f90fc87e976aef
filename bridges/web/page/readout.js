// SPDX-License-Identifier: Apache-2.0
//
// The values of the pixel that is pointed at: from the raw images where they are here, else from the server's answer in the frame.

import { depthOf } from './colours.js'
import { rawValues } from './frame.js'
import { NONE, fixed, metres, write } from './text.js'

const by = id => document.getElementById(id)

/** Returns { disparity_px, depth_m, confidence, depth_error_m } of a pixel; null = unknown there, undefined = not known here. */
export function valuesAt(frame, place) {
  if (!frame || !place) return {}
  const { point } = frame.header
  const same = point && Math.floor(point.x) === place.x && Math.floor(point.y) === place.y
  // Every frame has a confidence. One that was on its way when the pixel was first asked for does not carry it, and tells nothing.
  const told = same && point.confidence !== null ? point : {}
  const values = { ...told, ...rawValues(frame, place.x, place.y) }
  // A depth is not served by every daemon, or not asked for: the disparity says the same.
  if ((values.depth_m ?? null) === null && values.disparity_px) values.depth_m = depthOf(values.disparity_px, frame.header)
  return values
}

/** Shows the values and returns them. */
export function showReadout(frame, place) {
  const values = valuesAt(frame, place)
  const show = (id, value, text) => write(by(id), value === undefined ? NONE : value === null ? 'unknown' : text(value))
  write(by('at-pixel'), place ? `${place.x}, ${place.y}` : 'point at one')
  show('at-disparity', values.disparity_px, value => `${fixed(value, 2)} px`)
  show('at-depth', values.depth_m, metres)
  show('at-sigma', values.depth_error_m, value => `± ${metres(value)}`)
  show('at-confidence', values.confidence, value => value === 0 ? '0, rejected' : `${value} / 255`)
  by('readout').dataset.publishIndex = place && frame ? frame.header.publish_index : ''
  return values
}
