// SPDX-License-Identifier: Apache-2.0
//
// Small charts: the course of a number over the last 90 s, and the times of the daemon's stages.

import { duration, make, write } from './text.js'

const SHOWN_MS = 90000

const shades = new Map() // a frame of the radar asks more than a hundred times
matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => shades.clear())

/** A colour of page.css by its name, such as "accent", for canvases. */
export function shade(name) {
  if (!shades.has(name)) shades.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim())
  return shades.get(name)
}

/** A canvas as large as the screen's pixels, cleared. Returns { context, width, height } in CSS px, or null while it is not shown. */
export function cleared(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas
  if (!width || !height) return null
  const ratio = devicePixelRatio
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio)
    canvas.height = Math.round(height * ratio)
  }
  const context = canvas.getContext('2d')
  context.setTransform(ratio, 0, 0, ratio, 0, 0)
  context.clearRect(0, 0, width, height)
  return { context, width, height }
}

/** The least of 1, 2, 5 times a power of ten that is not less than a value. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value))
  return [1, 2, 5, 10].map(n => n * power).find(n => n >= value * 0.999)
}

/** A power of ten of microseconds. */
const roundTime = us => us < 1e3 ? `${us} µs` : us < 1e6 ? `${us / 1e3} ms` : `${us / 1e6} s`

/** A number over time. A null breaks the line: nothing was known then. */
export class Trend {
  #points = [] // { at, value }

  /** `least` is the least top of the scale, so that noise of an idle value does not fill the chart. */
  constructor(canvas, least) {
    this.canvas = canvas
    this.least = least
    this.context = canvas.getContext('2d')
  }

  add(value, at = performance.now()) {
    this.#points.push({ at, value })
    while (this.#points[0].at < at - SHOWN_MS) this.#points.shift()
    this.draw(at)
  }

  draw(now = performance.now()) {
    const area = cleared(this.canvas)
    if (!area) return
    const { context, width, height } = area
    const top = roundUp(Math.max(this.least, ...this.#points.map(point => point.value ?? 0)))
    const x = at => width - 3 - (now - at) / SHOWN_MS * (width - 3)
    const y = value => height - 2 - value / top * (height - 14)
    context.strokeStyle = shade('line')
    context.beginPath()
    for (const share of [0, 1]) context.rect(0, Math.round(y(share * top)) + 0.5, width, 0)
    context.stroke()
    context.fillStyle = shade('quiet')
    context.font = `10px ${getComputedStyle(this.canvas).fontFamily}`
    context.fillText(String(Number(top.toPrecision(3))), 0, 9)
    for (const run of this.#runs()) this.#drawRun(context, run, x, y, height)
  }

  #runs() {
    const runs = [[]]
    for (const point of this.#points) {
      if (point.value === null) runs.push([])
      else runs.at(-1).push(point)
    }
    return runs.filter(run => run.length)
  }

  #drawRun(context, run, x, y, height) {
    context.beginPath()
    run.forEach((point, i) => context[i ? 'lineTo' : 'moveTo'](x(point.at), y(point.value)))
    context.strokeStyle = shade('accent')
    context.lineWidth = 1.5
    context.lineJoin = 'round'
    context.stroke()
    context.lineTo(x(run.at(-1).at), height - 2)
    context.lineTo(x(run[0].at), height - 2)
    context.globalAlpha = 0.12
    context.fillStyle = shade('accent')
    context.fill()
    context.globalAlpha = 1
    context.lineWidth = 1
  }
}

/** A row for each stage: a dot at p50, a line to p99, on a logarithmic scale of time. */
export class StageChart {
  #names = ''

  constructor(root) {
    this.root = root
  }

  show(steps) {
    const names = steps.map(step => step.name).join('\n')
    if (names !== this.#names) this.#build(steps, names)
    if (!steps.length) return
    const low = 10 ** Math.floor(Math.log10(Math.max(1, Math.min(...steps.map(step => step.p50_us || 1)))))
    const high = 10 ** Math.ceil(Math.log10(Math.max(low * 10, ...steps.map(step => step.p99_us)) * 1.0001))
    const share = us => Math.max(0, Math.log(Math.max(us, low) / low) / Math.log(high / low))
    steps.forEach((step, i) => {
      const [, track, text] = this.root.children[i].children
      const [line, dot] = track.children
      line.style.left = dot.style.left = `${share(step.p50_us) * 100}%`
      line.style.width = `${(share(step.p99_us) - share(step.p50_us)) * 100}%`
      track.style.backgroundSize = `${100 / Math.log10(high / low)}% 100%`
      write(text, `${duration(step.p50_us)} – ${duration(step.p99_us)}`)
      track.title = `${step.name}: mean ${duration(step.mean_us)}, p90 ${duration(step.p90_us)}, most ${duration(step.max_us)}, ` +
        `${step.count} times. One column is a factor of ten.`
    })
    const [from, to] = this.root.lastElementChild.children[1].children
    write(from, roundTime(low))
    write(to, roundTime(high))
  }

  #build(steps, names) {
    this.#names = names
    const rows = steps.map(step => make('div', { className: `stage-row${step.name === 'total' ? ' total' : ''}` },
      make('span', { textContent: step.name, title: step.name }), make('span', { className: 'track' }, make('i'), make('b')),
      make('span', { className: 'figure' })))
    const axis = make('div', { className: 'stage-row axis quiet' }, make('span'),
      make('span', { className: 'ends' }, make('span'), make('span')), make('span'))
    this.root.replaceChildren(...rows, ...(rows.length ? [axis] : [make('p', { className: 'quiet', textContent: 'No times yet.' })]))
  }
}
