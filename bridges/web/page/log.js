// SPDX-License-Identifier: Apache-2.0
//
// The log of changes: each status is compared with the one before, and what differs gets a line with its time.

import { bytes, clockTime, make } from './text.js'

const MOST_LINES = 300

export class Log {
  #status = null
  #daemon = null

  constructor(list) {
    this.list = list
  }

  /** Adds a line. `tone` is 'good', 'warn', 'bad' or nothing. The newest line is the first. */
  add(text, tone = '') {
    const line = make('li', {}, make('time', { textContent: clockTime() }), make('span', { textContent: text }))
    line.dataset.tone = tone
    this.list.prepend(line)
    while (this.list.children.length > MOST_LINES) this.list.lastElementChild.remove()
  }

  /** Takes a status message of the server: { daemon, why, status }. */
  take({ daemon, why, status }) {
    if (daemon !== this.#daemon) this.#daemonChanged(daemon, why)
    this.#daemon = daemon
    if (!status) return
    const before = this.#status
    this.#status = status
    if (!before) return this.add(`${status.source || 'no source'}: ${stateOf(status)}`, toneOf(status))
    if (status.uptime_s < before.uptime_s) this.add('the daemon was started again', 'warn')
    this.#compare(before, status)
  }

  #daemonChanged(daemon, why) {
    if (daemon === 'gone') this.add(`the daemon is gone: ${why}`, 'bad')
    else if (this.#daemon === 'gone') this.add('the daemon is back', 'good')
  }

  #compare(before, now) {
    if (stateOf(before) !== stateOf(now)) this.add(stateOf(now), toneOf(now))
    if (before.source !== now.source) this.add(`source: ${now.source}`)
    if (sizeOf(before) !== sizeOf(now)) this.add(`image: ${sizeOf(now)}`)
    if (methodOf(before) !== methodOf(now)) this.add(`matching: ${methodOf(now)}`)
    if (before.camera?.state !== now.camera?.state) {
      this.add(`camera: ${now.camera?.state ?? 'none'}`, now.camera?.state === 'streaming' ? 'good' : 'warn')
    }
    if (before.sensors?.state !== now.sensors?.state) this.add(`sensors: ${now.sensors?.state ?? 'none'}`)
    this.#compareRecording(before.record, now.record)
    this.#compareCorrection(before.self_calibration, now.self_calibration)
    const [doubted, doubts] = [before, now].map(status => status.trust?.doubts ?? [])
    for (const doubt of doubts) if (!doubted.includes(doubt)) this.add(`doubt about the frames: ${doubt}`, 'warn')
    for (const doubt of doubted) if (!doubts.includes(doubt)) this.add(`the doubt is over: ${doubt}`, 'good')
    for (const notice of now.notices) if (!before.notices.includes(notice)) this.add(notice, 'warn')
  }

  #compareRecording(before, now) {
    if (!before.active && now.active) this.add(`recording to ${now.path}`, 'good')
    if (!before.active || now.active) return
    this.add(`recording ended: ${now.frames} frames, ${bytes(now.bytes)}${now.error ? `, ${now.error}` : ''}`, now.error ? 'bad' : '')
  }

  #compareCorrection(before, now) {
    if (!now) return
    if (!before?.corrected && now.corrected) this.add(`calibration corrected since frame ${now.since_sequence}`, 'good')
    if (before?.corrected && !now.corrected) this.add('the correction of the calibration is no longer in use', 'warn')
    if (before?.corrected && now.corrected && before.since_sequence !== now.since_sequence) {
      this.add(`calibration corrected anew since frame ${now.since_sequence}`)
    }
  }
}

const stateOf = status => status.state + (status.detail ? `: ${status.detail}` : '')
const toneOf = status => status.state === 'running' ? 'good' : 'warn'
const methodOf = status => `${status.method} on ${status.backend}`
const sizeOf = status => status.geometry ? `${status.geometry.width} x ${status.geometry.height} px` : 'no image'
