// SPDX-License-Identifier: Apache-2.0
//
// Frames as they come: each is decoded, drawn and acknowledged, in order. The server has at most two on the way, so a slow page gets
// fewer frames, not older ones.

import { imageOf, wordsOf } from './images.js'
import { AgeMeter } from './age.js'
import { metresTimesPixels, rangeOf } from './colours.js'
import { decode, headerOf } from './frame.js'
import { showReadout } from './readout.js'
import { settings } from './settings.js'

const RATE_OVER_MS = 2000

export class Live {
  /** The frame drawn last, with its raw images; null before the first. */
  frame = null
  /** The range [near, far] in m of the second picture's colours; null = unknown. */
  colours = null
  /** Frames that were not drawn because something in them was damaged. */
  broken = 0
  /** When the newest frame was drawn, by performance.now(). */
  drawnAt = -Infinity

  #parts
  #last = Promise.resolve()
  #age = new AgeMeter()
  #ages = []
  #times = []

  /** parts: { connection, left, right, pointer, legend, cloud, radar, toldProblem(text) }. */
  constructor(parts) {
    this.#parts = parts
  }

  /** Takes a binary message that came at `arrived` (Date.now()). */
  take(buffer, arrived) {
    this.#last = this.#last.then(() => this.#show(buffer, arrived))
  }

  /** A new connection: what was measured about the one before no longer holds. */
  reset() {
    this.#age.reset()
  }

  /** Frames drawn per second, of late. */
  get rate() {
    const now = performance.now()
    while (this.#times.length && this.#times[0] < now - RATE_OVER_MS) this.#times.shift()
    return this.#times.length / RATE_OVER_MS * 1000
  }

  /** The mean age in ms of the frames drawn since the last call; null without one. */
  takeAge() {
    const ages = this.#ages.splice(0)
    return ages.length ? ages.reduce((sum, age) => sum + age, 0) / ages.length : null
  }

  async #show(buffer, arrived) {
    const { connection, toldProblem } = this.#parts
    let index = null
    try {
      index = headerOf(buffer).publish_index
      const frame = await decode(buffer)
      this.#draw(frame)
      this.drawnAt = performance.now()
      this.#times.push(this.drawnAt)
      this.#ages.push(this.#age.ageOf(frame.header, arrived, Date.now(), connection.oneWayMs))
    } catch (error) {
      ++this.broken
      toldProblem(`a frame could not be drawn: ${error.message}`)
    }
    if (index !== null) connection.seen(index)
  }

  #draw(frame) {
    const { left, right, pointer, legend, cloud, radar } = this.#parts
    const { header, images } = frame
    const second = images[settings.image] ?? Object.values(images).find(image => image.name !== 'left')
    pointer.setSize(header.width, header.height)
    if (images.left) left.draw(images.left, header, captionOf(images.left, header))
    if (second) {
      right.draw(second, header, captionOf(second, header))
      legend.show(second, header, settings.range)
    }
    if (frame.cloud || !metresTimesPixels(header)) cloud.show(header, frame.cloud, images.left?.bitmap ?? null)
    this.colours = rangeOf(second)
    if (header.scan) radar.show(header.scan)
    for (const image of Object.values(images)) image.bitmap.close()
    this.frame = frame
    this.showPoint(pointer.place)
  }

  /** Shows the values of a pixel of the frame drawn last. */
  showPoint(place) {
    this.#parts.legend.point(showReadout(this.frame, place).depth_m)
  }
}

function captionOf(image, header) {
  const unrectified = imageOf(image.name).view === 'picture' && header.flags?.includes('unrectified')
  const size = header.scale > 1 ? ', smaller for a slow link' : ''
  return `${wordsOf(image.name)}${unrectified ? ', not rectified' : ''}${size}`
}
