// SPDX-License-Identifier: Apache-2.0
//
// The obstacle scan from above: the camera at the bottom, ahead is up. Bearings are positive to the left. What is not known to be free
// stays hatched: unknown is never free.

import { cleared, shade } from './charts.js'
import { metres, write } from './text.js'

const RINGS = [0.5, 1, 2, 5, 10, 20, 50]
const radians = degrees => degrees * Math.PI / 180

export class Radar {
  #scan = null

  constructor(root, nearest) {
    this.root = root
    this.canvas = root.querySelector('canvas')
    this.empty = root.querySelector('.no-picture')
    this.nearest = nearest
    new ResizeObserver(() => this.draw()).observe(this.canvas)
    matchMedia('(prefers-color-scheme: light)').addEventListener('change', () => this.draw())
  }

  /** Shows a scan, or why there is none. */
  show(scan, why = '') {
    this.#scan = scan
    write(this.empty, scan ? '' : why)
    this.root.classList.toggle('stale', !scan)
    write(this.nearest, scan ? nearestText(scan) : '')
    this.canvas.setAttribute('aria-label', scan ? `Obstacles from above. ${nearestText(scan)}` : why)
    this.draw()
  }

  /** Says why no new scan comes, '' = it does. An old scan is shown darker: it says nothing about now. */
  say(why) {
    this.root.classList.toggle('stale', why !== '')
    if (!this.#scan || why) write(this.empty, why)
    if (why) write(this.nearest, '')
  }

  draw() {
    const area = cleared(this.canvas)
    const scan = this.#scan
    if (!area || !scan) return
    const view = viewOf(scan, area)
    this.#drawUnknown(area.context, scan, view)
    for (const sector of scan.sectors) this.#drawSector(area.context, sector, view)
    this.#drawRings(area.context, scan, view)
    drawNearest(area.context, scan, view)
    drawCamera(area.context, view)
  }

  #drawUnknown(context, scan, view) {
    context.save()
    wedge(context, view, scan.sectors[0].from_deg, scan.sectors.at(-1).to_deg, 0, view.reach)
    context.fillStyle = shade('raised')
    context.fill()
    context.clip()
    context.strokeStyle = shade('line')
    context.beginPath()
    for (let x = -view.height; x < view.width; x += 7) {
      context.moveTo(x, view.height)
      context.lineTo(x + view.height, 0)
    }
    context.stroke()
    context.restore()
  }

  #drawSector(context, sector, view) {
    const free = Math.min(sector.free_m, view.reach)
    if (sector.state !== 'unknown' && free > 0) {
      wedge(context, view, sector.from_deg, sector.to_deg, 0, free)
      context.fillStyle = shade('free')
      context.fill()
    }
    if (sector.doubts.length) drawDoubt(context, sector, view)
    if (sector.state !== 'occupied' || sector.distance_m > view.reach) return
    // What is too near to be measured may be anywhere up to the distance.
    const depth = sector.near ? 0 : Math.max(view.reach * 0.025, sector.sigma_m ?? 0)
    const from = sector.near ? 0 : sector.distance_m
    wedge(context, view, sector.from_deg, sector.to_deg, from, Math.min(view.reach, sector.distance_m + depth))
    context.fillStyle = shade('bad')
    context.fill()
  }

  #drawRings(context, scan, view) {
    context.font = `10px ${getComputedStyle(this.canvas).fontFamily}`
    context.textAlign = 'left'
    const first = scan.sectors[0].from_deg
    const last = scan.sectors.at(-1).to_deg
    for (const ring of view.rings) {
      context.beginPath()
      arc(context, view, first, last, ring)
      context.strokeStyle = shade('ring')
      context.stroke()
      const edge = radians(first)
      context.fillStyle = shade('quiet')
      const x = Math.min(view.width - 30, view.x - Math.sin(edge) * ring * view.scale + 4)
      context.fillText(`${ring} m`, x, view.y - Math.cos(edge) * ring * view.scale + 12)
    }
  }
}

/** The nearest obstacle { distance, bearing, near, doubts }, or null. */
function nearestOf(scan) {
  const occupied = scan.sectors.filter(sector => sector.state === 'occupied').sort((a, b) => a.distance_m - b.distance_m)
  if (!occupied.length) return null
  const { distance_m: distance, from_deg: from, to_deg: to, near, doubts } = occupied[0]
  return { distance, bearing: (from + to) / 2, near, doubts }
}

function nearestText(scan) {
  const nearest = nearestOf(scan)
  if (!nearest) return 'no obstacle seen'
  const { distance, bearing, near, doubts } = nearest
  const side = Math.abs(bearing) < 0.5 ? 'ahead' : `${Math.abs(bearing).toFixed(0)}° ${bearing > 0 ? 'left' : 'right'}`
  return `nearest ${near ? 'at most ' : ''}${metres(distance)}, ${side}${doubts.length ? `, in doubt: ${doubts.join(' ')}` : ''}`
}

/** Marks a sector that can be trusted less at its far end. */
function drawDoubt(context, sector, view) {
  wedge(context, view, sector.from_deg, sector.to_deg, view.reach * 0.985, view.reach)
  context.fillStyle = shade('warn')
  context.fill()
}

/** Chooses how far the radar shows, so that most of what is known fits, and the scale that fits the canvas. */
function viewOf(scan, { width, height }) {
  const known = scan.sectors.map(sector => sector.distance_m ?? sector.free_m).filter(value => value > 0).sort((a, b) => a - b)
  const most = known.length ? known[Math.floor((known.length - 1) * 0.95)] * 1.15 : scan.max_m
  const reach = Math.min(scan.max_m, [1, 2, 3, 5, 7.5, 10, 15, 20, 30, 50, 100].find(value => value >= most) ?? scan.max_m)
  const widest = Math.max(...scan.sectors.map(sector => Math.max(Math.abs(sector.from_deg), Math.abs(sector.to_deg))))
  const half = Math.sin(radians(Math.min(widest, 90)))
  const below = widest > 90 ? -Math.cos(radians(widest)) : 0
  const scale = Math.min((width - 44) / 2 / half, (height - 34) / (1 + below)) / reach
  const rings = RINGS.filter(ring => ring <= reach * 1.001 && ring >= reach / 12)
  return { width, height, reach, scale, rings, x: width / 2, y: (height + (1 - below) * reach * scale) / 2 }
}

/** Adds an arc between two bearings at a distance to the path. */
function arc(context, view, from, to, distance, back = false) {
  const angle = bearing => -Math.PI / 2 - radians(bearing)
  context.arc(view.x, view.y, distance * view.scale, angle(back ? from : to), angle(back ? to : from), back)
}

function wedge(context, view, from, to, near, far) {
  context.beginPath()
  arc(context, view, from, to, far)
  arc(context, view, from, to, near, true)
  context.closePath()
}

function drawNearest(context, scan, view) {
  const nearest = nearestOf(scan)
  if (!nearest || nearest.distance > view.reach) return
  const angle = radians(nearest.bearing)
  const x = view.x - Math.sin(angle) * nearest.distance * view.scale
  const y = view.y - Math.cos(angle) * nearest.distance * view.scale
  context.beginPath()
  context.moveTo(view.x, view.y)
  context.lineTo(x, y)
  context.strokeStyle = shade('text')
  context.setLineDash([3, 3])
  context.stroke()
  context.setLineDash([])
  context.beginPath()
  context.arc(x, y, 4, 0, 2 * Math.PI)
  context.fillStyle = shade('text')
  context.fill()
}

function drawCamera(context, view) {
  context.beginPath()
  context.moveTo(view.x, view.y - 8)
  context.lineTo(view.x - 7, view.y + 6)
  context.lineTo(view.x + 7, view.y + 6)
  context.closePath()
  context.fillStyle = shade('accent')
  context.fill()
}
