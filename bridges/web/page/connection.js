// SPDX-License-Identifier: Apache-2.0
//
// The connection to disparity-web: its session, the WebSocket /live, and coming back by itself. Everything else hears of it through the
// handlers: state({ link, why }), hello, status, sensors, frame (an ArrayBuffer) and error (a line).

import { BASE } from './place.js'

const FIRST_WAIT_MS = 250
const LONGEST_WAIT_MS = 1800
const SILENCE_MS = 5000 // a status comes every second

/** Asks the server, about this page's daemon where there are several. Returns the JSON of its answer; throws an Error with the server's
 * one line, and its `status` where it has answered. */
export async function ask(path, options = {}) {
  let response
  try {
    response = await fetch(BASE + path, { cache: 'no-store', ...options })
  } catch {
    throw new Error(`disparity-web does not answer at ${location.host}`)
  }
  const answer = await response.json().catch(() => null)
  if (!response.ok) {
    const line = answer?.error ?? `${path}: ${response.status} ${response.statusText}`
    throw Object.assign(new Error(line), { status: response.status })
  }
  return answer
}

export function post(path, body) {
  return ask(path, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) })
}

export class Connection {
  /** The session as the server described it last. */
  session = { needs_token: false, view: false, control: false }
  /** Half the time of a question and its answer, ms: about what a message takes on its way. */
  oneWayMs = 0
  /** Bytes received in all. */
  received = 0

  #handlers
  #base
  #socket = null
  #subscription = null
  #sent = null
  #wait = FIRST_WAIT_MS
  #timer = 0
  #watch = 0
  #why = ''
  #closed = false

  /** `base`: of the daemon's paths, as BASE is. */
  constructor(handlers, base = BASE) {
    this.#handlers = handlers
    this.#base = base
  }

  get open() {
    return this.#socket?.readyState === WebSocket.OPEN
  }

  /** Connects now; afterwards it connects again by itself whenever the connection is lost. */
  async connect() {
    if (this.#closed) return
    clearTimeout(this.#timer)
    try {
      const begun = performance.now()
      this.session = await ask('/api/session')
      this.oneWayMs = (performance.now() - begun) / 2
      if (BASE && this.session.view) await ask('/api/status') // says why where no such daemon was found yet
    } catch (error) {
      return this.#later(error.message, error.status === 404 ? 'absent' : 'lost')
    }
    if (this.session.needs_token && !this.session.view) return this.#handlers.state({ link: 'token', why: '' })
    this.#openSocket()
  }

  /** Ends the connection for good. */
  close() {
    this.#closed = true
    clearTimeout(this.#timer)
    clearTimeout(this.#watch)
    const before = this.#socket
    this.#socket = null
    before?.close()
  }

  /** Shows the token to the server. Throws its line when it is the wrong one. */
  async logIn(token) {
    this.session = await post('/api/session', { token })
    // A connection keeps the rights that it began with.
    const before = this.#socket
    this.#socket = null
    clearTimeout(this.#watch)
    before?.close()
    await this.connect()
  }

  /** What the page wants to see. Sent when it differs from what was sent before, and again after each new connection. */
  subscribe(subscription) {
    this.#subscription = JSON.stringify({ type: 'subscribe', ...subscription })
    this.#sendSubscription()
  }

  seen(publishIndex) {
    this.#send({ type: 'seen', publish_index: publishIndex })
  }

  /** Which pixel of the whole image the page wants to know about; null = none. */
  point(place) {
    this.#send(place ? { type: 'point', x: place.x, y: place.y } : { type: 'point' })
  }

  #openSocket() {
    if (this.#closed) return
    const socket = new WebSocket(`${location.origin.replace(/^http/, 'ws')}${this.#base}/live`, 'disparityd.live.v1')
    socket.binaryType = 'arraybuffer'
    this.#socket = socket
    this.#sent = null
    this.#why = ''
    this.#listen(socket)
    this.#watchSilence(socket)
  }

  #listen(socket) {
    socket.onopen = () => {
      this.#handlers.state({ link: 'open', why: '' })
      this.#sendSubscription()
    }
    socket.onmessage = message => {
      this.#watchSilence(socket)
      this.#wait = FIRST_WAIT_MS
      this.#take(message.data)
    }
    socket.onclose = event => {
      if (this.#socket !== socket) return
      clearTimeout(this.#watch)
      this.#socket = null
      this.#later(this.#why || event.reason || `the connection to disparity-web at ${location.host} was lost`)
    }
  }

  #take(data) {
    if (typeof data !== 'string') {
      this.received += data.byteLength
      return this.#handlers.frame(data, Date.now())
    }
    this.received += data.length
    const message = JSON.parse(data)
    if (message.type === 'error') this.#handlers.error(message.error)
    else this.#handlers[message.type]?.(message)
  }

  /** A connection whose other end has vanished says nothing: it is given up after some silence. */
  #watchSilence(socket) {
    clearTimeout(this.#watch)
    this.#watch = setTimeout(() => {
      if (this.#socket !== socket) return
      socket.onclose = null
      socket.onmessage = null
      socket.close()
      this.#socket = null
      this.#later(`no word from disparity-web at ${location.host} for ${SILENCE_MS / 1000} s`)
    }, SILENCE_MS)
  }

  #later(why, link = 'lost') {
    this.#handlers.state({ link, why })
    clearTimeout(this.#timer)
    this.#timer = setTimeout(() => this.connect(), this.#wait)
    this.#wait = Math.min(LONGEST_WAIT_MS, this.#wait * 2)
  }

  #sendSubscription() {
    if (!this.open || !this.#subscription || this.#sent === this.#subscription) return
    this.#socket.send(this.#subscription)
    this.#sent = this.#subscription
  }

  #send(message) {
    if (this.open) this.#socket.send(JSON.stringify(message))
  }
}
