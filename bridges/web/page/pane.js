// SPDX-License-Identifier: Apache-2.0
//
// One image as it comes, on the page of a daemon and on that of all: a canvas, and a line over it for when there is nothing new.

import { write } from './text.js'

/** Without a frame for so long, an image says so. */
export const NO_FRAME_MS = 2000

export class Pane {
  /** `figure` has a canvas and an element of the class no-picture. */
  constructor(figure) {
    this.figure = figure
    this.canvas = figure.querySelector('canvas')
    this.empty = figure.querySelector('.no-picture')
    this.context = this.canvas.getContext('2d')
  }

  /** Draws a decoded image. `whole` is the frame's header: the size in which pixels are counted. */
  draw(image, whole) {
    if (this.canvas.width !== image.bitmap.width || this.canvas.height !== image.bitmap.height) {
      this.canvas.width = image.bitmap.width
      this.canvas.height = image.bitmap.height
    }
    this.figure.style.aspectRatio = `${whole.width} / ${whole.height}`
    this.context.drawImage(image.bitmap, 0, 0)
    this.canvas.dataset.publishIndex = whole.publish_index
    this.say('')
  }

  /** Says in the image why nothing new comes; '' = it does. What was drawn last stays, darker. */
  say(text) {
    write(this.empty, text)
    this.figure.classList.toggle('stale', text !== '')
  }
}
