// SPDX-License-Identifier: Apache-2.0
//
// The legend under the pictures: a bar that has at each distance the colour which the picture gives it, with a scale in metres and two
// handles, the ends of the range of colours. It is logarithmic in metres. Without a calibration it is in pixels of disparity; confidence
// and depth error have scales of their own, without handles.

import { imageOf } from './images.js'
import { measurable, placeOf, rangeOf, turbo } from './colours.js'
import { metres, write } from './text.js'
import { shade } from './charts.js'

const STEPS = 1000
const CLOSEST = 1.05 // far / near at the least
const TICKS = [0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30, 40, 50, 65]
const BAR_PX = 16
const HANDLE_PX = 18 // as in page.css: a range input's thumb stays inside its track

export class Legend {
  #scale = null // what is drawn: { ends: [near, far], log, colourAt(value), text(value) }
  #drawn = ''
  #handles

  /** onRange([near, far] or null) is called when the user has chosen a range, null = auto. */
  constructor(root, onRange) {
    this.canvas = root.querySelector('canvas')
    this.near = root.querySelector('#range-near')
    this.far = root.querySelector('#range-far')
    this.auto = root.querySelector('#range-auto')
    this.text = root.querySelector('#range-text')
    this.mark = root.querySelector('#legend-mark')
    this.#handles = [this.near, this.far]
    this.onRange = onRange
    this.near.addEventListener('input', () => this.#choose(this.near))
    this.far.addEventListener('input', () => this.#choose(this.far))
    this.auto.addEventListener('click', () => this.onRange(null))
    new ResizeObserver(() => this.#draw()).observe(this.canvas)
    matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => this.#draw())
  }

  /** Shows the scale of an image of a frame (its entry in the header's images). `chosen` is the user's range or null. */
  show(image, header, chosen) {
    const distances = imageOf(image.name).view === 'distance'
    const all = measurable(header)
    const range = rangeOf(image) ?? chosen ?? all
    const key = JSON.stringify([image.name, image.range_m, image.range, all, chosen])
    this.auto.setAttribute('aria-pressed', String(!chosen))
    this.auto.disabled = !distances || !all
    for (const handle of this.#handles) handle.hidden = !distances || !all
    if (key === this.#drawn) return
    this.#drawn = key
    this.#scale = distances ? (all ? ofDistances(image, header, range, all) : ofDisparities(image)) : ofValues(image)
    if (distances && all) {
      this.#put(this.near, range[0])
      this.#put(this.far, range[1])
    }
    write(this.text, this.#scale.summary)
    this.#draw()
  }

  /** Marks a distance in metres, null = none. */
  point(distance) {
    const shown = this.#scale?.log && distance ? this.#share(distance) : null
    this.mark.hidden = shown === null || shown < 0 || shown > 1
    if (!this.mark.hidden) this.mark.style.left = `calc(${HANDLE_PX / 2}px + ${shown} * (100% - ${HANDLE_PX}px))`
  }

  #share(value) {
    const [low, high] = this.#scale.ends
    return this.#scale.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low)
  }

  #valueAt(share) {
    const [low, high] = this.#scale.ends
    return this.#scale.log ? low * (high / low) ** share : low + share * (high - low)
  }

  /** Puts a handle at a distance; one beyond the scale at its end. */
  #put(handle, value) {
    if (document.activeElement !== handle || !handle.matches(':active')) handle.value = Math.round(Math.min(1, this.#share(value)) * STEPS)
    handle.setAttribute('aria-valuetext', distanceText(value))
  }

  #choose(moved) {
    if (!this.#scale?.log) return
    let near = this.#valueAt(this.near.value / STEPS)
    let far = this.#valueAt(this.far.value / STEPS)
    if (far < near * CLOSEST) {
      if (moved === this.near) far = near * CLOSEST
      else near = far / CLOSEST
    }
    const three = value => Number(value.toPrecision(3))
    this.onRange([three(near), three(far)])
  }

  #draw() {
    const width = this.canvas.clientWidth
    if (!this.#scale || !width) return
    const ratio = devicePixelRatio
    const height = this.canvas.clientHeight
    this.canvas.width = Math.round(width * ratio)
    this.canvas.height = Math.round(height * ratio)
    const context = this.canvas.getContext('2d')
    context.scale(ratio, ratio)
    const inner = width - HANDLE_PX
    context.beginPath()
    context.roundRect(HANDLE_PX / 2, 2, inner, BAR_PX, 4)
    context.save()
    context.clip()
    for (let x = 0; x < inner; ++x) {
      context.fillStyle = this.#scale.colourAt(this.#valueAt(x / inner))
      context.fillRect(HANDLE_PX / 2 + x, 2, 1.5, BAR_PX)
    }
    context.restore()
    this.#drawTicks(context, inner)
  }

  #drawTicks(context, inner) {
    context.fillStyle = shade('quiet')
    context.font = `11px ${getComputedStyle(this.canvas).fontFamily}`
    context.textAlign = 'center'
    let free = -Infinity
    for (const value of this.#scale.ticks) {
      const share = this.#share(value)
      if (share < 0 || share > 1) continue
      const text = this.#scale.text(value)
      const half = context.measureText(text).width / 2
      const x = HANDLE_PX / 2 + share * inner
      context.fillRect(x - 0.5, BAR_PX + 3, 1, 4)
      const middle = Math.min(Math.max(x, half), inner + HANDLE_PX - half)
      if (middle - half < free) continue
      context.fillText(text, middle, BAR_PX + 18)
      free = middle + half + 8
    }
  }
}

const distanceText = value => value === Infinity ? '∞' : metres(value)

function ofDistances(image, header, range, all) {
  const ends = [Math.min(all[0], range[0]), Math.max(all[1], Number.isFinite(range[1]) ? range[1] : 0)]
  return {
    ends,
    log: true,
    ticks: TICKS,
    colourAt: value => turbo(placeOf(value, image.name, range, header)),
    text: value => `${value} m`,
    summary: `${distanceText(range[0])} – ${distanceText(range[1])}`,
  }
}

function ofDisparities(image) {
  const [low, high] = (image.range ?? [0, 16]).map(value => value / 16)
  return {
    ends: [low, high],
    log: false,
    ticks: evenTicks(low, high),
    colourAt: value => turbo((value - low) / (high - low)),
    text: value => `${value} px`,
    summary: 'no calibration: px',
  }
}

function ofValues(image) {
  const { view, unit } = imageOf(image.name)
  const spread = view === 'spread'
  const scale = unit === 'mm' ? 1000 : 1
  const [low, high] = (image.range ?? [0, 255]).map(value => value / scale)
  return {
    ends: [low, high],
    log: false,
    ticks: evenTicks(low, high),
    colourAt: value => spread ? turbo((value - low) / (high - low)) : `rgb(${value} ${value} ${value})`,
    text: value => unit === 'mm' ? `${value} m` : String(value),
    summary: spread ? 'one sigma' : view === 'grey' ? '0 = rejected' : '',
  }
}

function evenTicks(low, high) {
  const rough = (high - low) / 8
  const power = 10 ** Math.floor(Math.log10(rough))
  const step = [1, 2, 5, 10].map(n => n * power).find(n => n >= rough)
  const ticks = []
  for (let value = Math.ceil(low / step) * step; value <= high + step / 1e3; value += step) ticks.push(Number(value.toPrecision(6)))
  return ticks
}
