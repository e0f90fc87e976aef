// SPDX-License-Identifier: Apache-2.0
//
// The two pictures and the pixel that is pointed at. Mouse: the pixel under the pointer; a click holds it. Touch: the pixel that is
// tapped. Keyboard: arrows move it by 1 px, with Shift by 10, Escape lets it go. Pixels are those of the whole rectified image.

import { Pane } from './pane.js'

/** One picture: an image, its caption, and a cross. */
export class Picture extends Pane {
  constructor(figure) {
    super(figure)
    this.caption = figure.querySelector('figcaption')
    this.across = figure.querySelector('.across')
    this.down = figure.querySelector('.down')
  }

  draw(image, whole, caption) {
    super.draw(image, whole)
    this.figure.style.setProperty('--ratio', whole.width / whole.height)
    this.figure.classList.add('has-picture')
    this.setCaption(caption)
  }

  setCaption(text) {
    if (this.caption.textContent !== text) this.caption.textContent = text
    this.figure.setAttribute('aria-label', `${text}. Arrow keys move the pixel whose values are shown.`)
  }

  cross(place, size) {
    this.figure.classList.toggle('crossed', place !== null)
    if (!place) return
    this.across.style.top = `${(place.y + 0.5) / size.height * 100}%`
    this.down.style.left = `${(place.x + 0.5) / size.width * 100}%`
  }
}

/** Knows which pixel is pointed at in any of the pictures. onChange(place or null) is called when it becomes another one. */
export class Pointer {
  place = null

  #held = null
  #size = { width: 0, height: 0 }

  constructor(pictures, onChange) {
    this.pictures = pictures
    this.onChange = onChange
    for (const picture of pictures) this.#listen(picture.figure)
  }

  /** The size of the whole image. A pixel that is no longer inside is let go. */
  setSize(width, height) {
    if (this.#size.width === width && this.#size.height === height) return
    this.#size = { width, height }
    if (this.place && (this.place.x >= width || this.place.y >= height)) this.release()
    this.#show()
  }

  release() {
    this.#held = null
    this.#move(null)
  }

  #listen(figure) {
    figure.addEventListener('pointermove', event => {
      if (event.pointerType === 'mouse') this.#move(this.#placeAt(figure, event))
      else if (figure.hasPointerCapture(event.pointerId)) this.#hold(this.#placeAt(figure, event))
    })
    figure.addEventListener('pointerdown', event => {
      if (event.button !== 0) return
      if (event.pointerType !== 'mouse') figure.setPointerCapture(event.pointerId)
      const place = this.#placeAt(figure, event)
      const again = this.#held && place && Math.hypot(place.x - this.#held.x, place.y - this.#held.y) < 6
      if (again) this.release()
      else this.#hold(place)
    })
    figure.addEventListener('pointerleave', event => {
      if (event.pointerType === 'mouse') this.#move(this.#held)
    })
    figure.addEventListener('keydown', event => this.#onKey(event))
  }

  #onKey(event) {
    const directions = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }
    const direction = directions[event.key]
    if (event.key === 'Escape') return this.release()
    if (!direction || !this.#size.width || event.ctrlKey || event.altKey || event.metaKey) return
    event.preventDefault()
    const by = event.shiftKey ? 10 : 1
    const from = this.place ?? { x: Math.floor(this.#size.width / 2), y: Math.floor(this.#size.height / 2) }
    const inside = (value, size) => Math.min(size - 1, Math.max(0, value))
    this.#hold({ x: inside(from.x + by * direction[0], this.#size.width), y: inside(from.y + by * direction[1], this.#size.height) })
  }

  #placeAt(figure, event) {
    const box = figure.getBoundingClientRect()
    const x = Math.floor((event.clientX - box.left - figure.clientLeft) / figure.clientWidth * this.#size.width)
    const y = Math.floor((event.clientY - box.top - figure.clientTop) / figure.clientHeight * this.#size.height)
    return x >= 0 && y >= 0 && x < this.#size.width && y < this.#size.height ? { x, y } : null
  }

  #hold(place) {
    this.#held = place
    this.#move(place)
  }

  #move(place) {
    if (place?.x === this.place?.x && place?.y === this.place?.y) return
    this.place = place
    this.#show()
    this.onChange(place)
  }

  #show() {
    for (const picture of this.pictures) picture.cross(this.place, this.#size)
  }
}
