// SPDX-License-Identifier: Apache-2.0
//
// The camera's controls as sliders. They are asked for when a camera streams, and set one at a time; the camera's answer is shown.

import { ask, post } from './connection.js'
import { make } from './text.js'

const SETTLE_MS = 120 // a slider that is being drawn sends its value this often

/** Why a session without the right to control may only look. */
export const ONLY_LOOKING = 'You may look, not control: a control token is needed, or disparity-web --allow-control.'

const valueOf = input => input.type === 'checkbox' ? Number(input.checked) : Number(input.value)
const wordOf = (control, value) => control.min === 0 && control.max === 1 ? ['off', 'on'][value] : String(value)

export class Controls {
  #camera = '' // which camera the controls are of
  #rows = new Map() // name -> { control, slider, value, reset }; the slider is a box to tick where the control is 0 or 1
  #allowed = false
  #timers = new Map()

  constructor(root, onError) {
    this.root = root
    this.onError = onError
    this.#say('No camera yet.')
  }

  /** Follows the status: asks for the controls of each camera that begins to stream. */
  follow(status, allowed) {
    const camera = status?.camera?.state === 'streaming' ? `${status.camera.node} ${status.camera.serial} ${status.camera.arrivals}` : ''
    if (camera === this.#camera && allowed === this.#allowed) return
    this.#allowed = allowed
    if (camera !== this.#camera) {
      this.#camera = camera
      this.#rows.clear()
      if (camera) this.#load()
    }
    if (!camera) this.#say(status?.camera ? `The camera is ${status.camera.state}.` : 'No camera: the source is not live.')
    this.#permit()
  }

  async #load() {
    const camera = this.#camera
    try {
      const { controls } = await ask('/api/camera')
      if (camera === this.#camera) this.#show(controls)
    } catch (error) {
      if (camera === this.#camera) this.#say(error.message)
    }
  }

  #say(text) {
    this.root.replaceChildren(make('p', { className: 'quiet', textContent: text }))
  }

  #show(controls) {
    const same = controls.length === this.#rows.size && controls.every(control => this.#rows.has(control.name))
    if (!same) {
      this.#rows.clear()
      this.root.replaceChildren(...controls.map(control => this.#row(control)), this.#foot())
    }
    for (const control of controls) this.#put(control)
    this.#permit()
  }

  #row(control) {
    const label = control.name.replaceAll('-', ' ')
    const yesOrNo = control.min === 0 && control.max === 1
    const slider = make('input', yesOrNo ? { type: 'checkbox' } : { type: 'range', min: control.min, max: control.max, step: 1 })
    slider.setAttribute('aria-label', label)
    const value = make('output')
    const reset = make('button', { type: 'button', className: 'small', textContent: 'Reset', title: `Back to ${control.default}, the default` })
    reset.setAttribute('aria-label', `Reset ${label} to ${control.default}`)
    slider.addEventListener('input', () => {
      value.textContent = wordOf(control, valueOf(slider))
      this.#setSoon(control.name, slider)
    })
    reset.addEventListener('click', () => this.#set(control.name, control.default))
    this.#rows.set(control.name, { control, slider, value, reset })
    const ends = make('small', { className: 'quiet', textContent: `${control.min} – ${control.max}` })
    return make('div', { className: 'control' }, make('span', {}, label, ...(yesOrNo ? [] : [ends])), slider, value, reset)
  }

  #foot() {
    const all = make('button', { type: 'button', textContent: 'Reset all' })
    all.addEventListener('click', async () => {
      for (const [name, { control, slider }] of this.#rows) if (valueOf(slider) !== control.default) await this.#set(name, control.default)
    })
    this.all = all
    this.reason = make('p', { className: 'quiet reason', textContent: ONLY_LOOKING })
    return make('div', { className: 'buttons' }, this.reason, all)
  }

  #put(control) {
    const row = this.#rows.get(control.name)
    row.control = control
    if (row.slider.type === 'checkbox') row.slider.checked = control.value === 1
    else if (!row.slider.matches(':active')) row.slider.value = control.value
    row.value.textContent = wordOf(control, control.value)
    row.reset.classList.toggle('at-default', control.value === control.default)
  }

  #permit() {
    for (const { slider, reset } of this.#rows.values()) slider.disabled = reset.disabled = !this.#allowed
    if (!this.#rows.size) return
    this.all.disabled = !this.#allowed
    this.reason.hidden = this.#allowed
  }

  #setSoon(name, slider) {
    if (this.#timers.has(name)) return
    this.#timers.set(name, setTimeout(() => {
      this.#timers.delete(name)
      this.#set(name, valueOf(slider))
    }, SETTLE_MS))
  }

  async #set(name, value) {
    try {
      const { controls } = await post('/api/camera', { name, value })
      this.#show(controls)
    } catch (error) {
      this.onError(error.message)
      const row = this.#rows.get(name)
      if (row) this.#put(row.control)
    }
  }
}
