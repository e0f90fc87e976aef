// SPDX-License-Identifier: Apache-2.0
//
// Starting and stopping a recording of the daemon: the button in the bar, and the dialog that asks for a file name.

import { ONLY_LOOKING } from './controls.js'
import { ask, post } from './connection.js'
import { uptime, write } from './text.js'

const by = id => document.getElementById(id)

/** A name by the time now, such as 2026-11-26_13-05-10.mkv. */
export function usualName(date = new Date()) {
  const two = value => String(value).padStart(2, '0')
  const day = [date.getFullYear(), two(date.getMonth() + 1), two(date.getDate())].join('-')
  return `${day}_${[date.getHours(), date.getMinutes(), date.getSeconds()].map(two).join('-')}.mkv`
}

export class Recording {
  #active = false

  constructor(onError) {
    this.button = by('record')
    this.dialog = by('record-dialog')
    this.onError = onError
    this.button.addEventListener('click', () => this.toggle())
    by('record-cancel').addEventListener('click', () => this.dialog.close())
    by('record-form').addEventListener('submit', event => {
      event.preventDefault()
      this.#start(by('record-path').value.trim())
    })
  }

  /** Shows how the recording stands. `why` says why the button cannot be used, '' = it can. */
  follow(status, allowed) {
    this.#active = Boolean(status?.record?.active)
    const why = !status ? 'There is no daemon.' : allowed ? '' : ONLY_LOOKING
    this.button.disabled = why !== ''
    this.button.title = why || (this.#active ? 'Stop the recording (r)' : 'Record raw frames (r)')
    this.button.setAttribute('aria-pressed', String(this.#active))
    write(by('record-text'), this.#active ? `Stop ${uptime(status.record.seconds)}` : 'Record')
  }

  toggle() {
    if (this.button.disabled) return
    if (this.#active) return this.#stop()
    by('record-path').value = usualName()
    this.#say('')
    this.dialog.showModal()
    by('record-path').select()
  }

  #say(text) {
    by('record-error').hidden = text === ''
    write(by('record-error'), text)
  }

  async #start(path) {
    try {
      await post('/api/recording', { path })
      this.dialog.close()
    } catch (error) {
      this.#say(error.message)
    }
  }

  async #stop() {
    try {
      await ask('/api/recording', { method: 'DELETE' })
    } catch (error) {
      this.onError(error.message)
    }
  }
}
