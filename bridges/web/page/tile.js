// SPDX-License-Identifier: Apache-2.0
//
// One daemon of several, small: its newest picture, its state, and a link to its page. What is not on the screen asks for no pictures.

import { Connection } from './connection.js'
import { decode, headerOf } from './frame.js'
import { NO_FRAME_MS, Pane } from './pane.js'
import { problemOf } from './status.js'
import { fixed, make, write } from './text.js'

const MOST_RATE = 5 // frames per second: enough to see that it lives
const WIDTHS = [320, 480, 640] // of those that disparity-web makes

export class Tile {
  /** Whether the daemon gives what it should. */
  well = false

  #onScreen = false
  #connection
  #connected = false
  #products = []
  #lost = false // the connection
  #asks = false // for pictures
  #askedAt = 0 // since when, by performance.now()
  #drawnAt = 0
  #last = Promise.resolve()

  constructor({ name, path }) {
    this.picture = make('div', { className: 'picture' }, make('canvas', { width: 672, height: 376 }),
      make('p', { className: 'no-picture', textContent: 'no picture yet' }))
    this.pane = new Pane(this.picture)
    this.state = make('span', { className: 'pill' })
    this.synthetic = make('span', { className: 'tag', textContent: 'synthetic', title: 'A computer drew these frames. No camera saw them.', hidden: true })
    this.recording = make('span', { className: 'recording', textContent: 'recording', hidden: true })
    this.facts = make('p', { className: 'quiet' })
    this.why = make('p', { className: 'why' })
    const head = make('div', { className: 'tile-head' }, make('h2', { textContent: name }), this.state, this.synthetic, this.recording)
    this.item = make('li', {}, make('a', { className: 'card tile', href: path }, this.picture, head, this.facts, this.why))
    this.item.dataset.name = name
    const ignore = () => {}
    this.#connection = new Connection({
      state: ({ link, why }) => {
        this.#lost = link === 'lost'
        if (this.#lost) this.pane.say(why)
        else this.#askedAt = performance.now()
      },
      hello: ({ products }) => {
        this.#products = products
        this.#subscribe()
      },
      frame: buffer => { this.#last = this.#last.then(() => this.#draw(buffer)) },
      status: ignore,
      sensors: ignore,
      error: ignore,
    }, path.replace(/\/$/, ''))
  }

  /** Shows what the list of the server says of the daemon. */
  show(entry) {
    const gone = entry.daemon === 'gone'
    const problem = gone ? { title: 'gone', text: entry.why } : entry.state ? problemOf(entry) : null
    this.well = !gone && Boolean(entry.state) && !problem
    write(this.state, gone ? 'gone' : entry.state ?? 'connecting')
    this.state.dataset.tone = gone ? 'bad' : problem ? 'warn' : this.well ? 'good' : 'quiet'
    this.synthetic.hidden = !entry.synthetic
    this.recording.hidden = !entry.recording
    write(this.facts, gone || !entry.state ? '' : `${fixed(entry.rate, 1)} /s, ${entry.source}`)
    write(this.why, problem ? gone ? problem.text : `${problem.title}: ${problem.text}` : '')
    if (gone) this.pane.say('no picture')
    else if (!this.#lost) this.#saySilence(problem?.title ?? (entry.state === 'idle' ? 'idle' : ''))
  }

  /** Follows whether anybody can see the tile. It connects when that is so for the first time. */
  look({ onScreen = this.#onScreen }) {
    this.#onScreen = onScreen
    if (onScreen && !this.#connected) {
      this.#connected = true
      this.#connection.connect()
    }
    this.#subscribe()
  }

  /** Connects again where a token was needed. */
  again() {
    if (this.#connected && !this.#connection.open) this.#connection.connect()
  }

  close() {
    this.#connection.close()
    this.item.remove()
  }

  #subscribe() {
    const image = ['disparity', 'left'].find(name => this.#products.includes(name))
    const wanted = this.#onScreen && !document.hidden && image
    if (wanted && !this.#asks) this.#askedAt = performance.now()
    this.#asks = Boolean(wanted)
    const pixels = this.picture.clientWidth * devicePixelRatio
    this.#connection.subscribe({
      images: wanted ? [image] : [],
      encoding: 'jpeg',
      max_width: WIDTHS.find(width => width >= pixels) ?? WIDTHS.at(-1),
      max_rate: MOST_RATE,
    })
  }

  async #draw(buffer) {
    let index = null
    try {
      index = headerOf(buffer).publish_index
      const { header, images } = await decode(buffer)
      for (const image of Object.values(images)) {
        this.pane.draw(image, header)
        image.bitmap.close()
      }
      this.#drawnAt = performance.now()
    } catch (error) {
      this.pane.say(`a frame could not be drawn: ${error.message}`)
    }
    if (index !== null) this.#connection.seen(index)
  }

  /** Says in the picture that no new one has come for a while: `why`, where that is known. */
  #saySilence(why) {
    const silent = performance.now() - Math.max(this.#drawnAt, this.#askedAt)
    if (silent < NO_FRAME_MS) return
    if (why) this.pane.say(why)
    else if (this.#asks) this.pane.say(`no frame for ${fixed(silent / 1000, 0)} s`)
  }
}
