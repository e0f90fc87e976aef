// SPDX-License-Identifier: Apache-2.0
//
// What the camera's sensors measure: motion, magnetic field, air, temperatures. A value that a sample lacks keeps the one before.

import { NONE, fixed, make, showFacts } from './text.js'

const OLD_MS = 2000
const REDRAW_MS = 200

const vector = (value, digits, factor = 1) => value ? value.map(part => fixed(part * factor, digits)).join(', ') : NONE
const length = value => value ? Math.hypot(...value) : null

export class Sensors {
  #values = {}
  #came = -Infinity
  #drawn = -Infinity
  #list = make('dl', { className: 'facts' })
  #line = make('p', { className: 'quiet' })

  constructor(root) {
    root.append(this.#line, this.#list)
  }

  /** Takes a sample as the server sends it. */
  take(sample) {
    const now = performance.now()
    Object.assign(this.#values, sample)
    this.#came = now
    if (now < this.#drawn + REDRAW_MS) return
    this.#drawn = now
    this.#line.hidden = true
    this.#list.hidden = false
    showFacts(this.#list, rowsOf(this.#values))
  }

  /** Says why nothing is measured, once samples have stopped. `sensors` is that of the daemon's status. */
  check(sensors) {
    if (performance.now() < this.#came + OLD_MS) return
    this.#values = {}
    this.#list.hidden = true
    this.#line.hidden = false
    const known = sensors && sensors.state !== 'streaming'
    this.#line.textContent = known ? `${sensors.state}${sensors.detail ? `: ${sensors.detail}` : ''}` : 'This source has no sensors, or sends nothing.'
  }
}

function rowsOf(values) {
  const rows = [
    ['Acceleration', `${vector(values.acceleration, 2)} m/s²`],
    ['… in all', `${fixed(length(values.acceleration), 2)} m/s²`],
    ['Turning', `${vector(values.angular_velocity, 1, 180 / Math.PI)} °/s`],
  ]
  if (values.magnetic_field) rows.push(['Magnetic field', `${vector(values.magnetic_field, 0)} µT`])
  rows.push(['IMU', `${fixed(values.imu_celsius, 1)} °C`])
  if (values.left_celsius !== undefined) rows.push(['Eyes', `${fixed(values.left_celsius, 1)}, ${fixed(values.right_celsius, 1)} °C`])
  if (values.celsius !== undefined) rows.push(['Air', `${fixed(values.celsius, 1)} °C, ${fixed(values.hectopascal, 1)} hPa, ${fixed(values.humidity_percent, 0)} %`])
  return rows
}
