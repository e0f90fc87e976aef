// SPDX-License-Identifier: Apache-2.0
//
// How old a frame is when it is on the screen. The server's clock and this one may differ, so only the time on the way is measured
// here: the fastest message of the last while is taken for one that waited nowhere.

const KEPT_MS = 60000
const SAME_CLOCK_MS = 2000

export class AgeMeter {
  #differences = [] // { at, value }: ascending values, so that the first is the least of the last minute

  constructor(sameMachine = ['localhost', '127.0.0.1', '[::1]'].includes(location.hostname)) {
    this.sameMachine = sameMachine
  }

  /** Forgets what it knows, after a new connection. */
  reset() {
    this.#differences = []
  }

  /** Returns the age in ms of a frame that came at `arrived` and is drawn at `drawn` (Date.now()). */
  ageOf(header, arrived, drawn, oneWayMs) {
    const sent = header.captured_ms + header.age_ms
    const difference = arrived - sent
    while (this.#differences.length && this.#differences.at(-1).value >= difference) this.#differences.pop()
    this.#differences.push({ at: arrived, value: difference })
    while (this.#differences[0].at < arrived - KEPT_MS) this.#differences.shift()
    const least = this.#differences[0].value
    const oneClock = this.sameMachine && least >= 0 && least < SAME_CLOCK_MS
    const way = oneClock ? difference : difference - least + oneWayMs
    return header.age_ms + way + (drawn - arrived)
  }
}
