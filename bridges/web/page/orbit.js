// SPDX-License-Identifier: Apache-2.0
//
// The viewer of the point cloud: turns around a point in front of the camera. Coordinates are those of the camera: x right, y down,
// z ahead, metres. Drag or arrow keys turn, Shift or two fingers or the right button shift, wheel, pinch, + and - move nearer and farther.

const FIELD_RAD = 0.9 // vertical angle of view
const NEAREST_M = 0.05

export class Orbit {
  /** onChange() is called when the view has changed. */
  constructor(canvas, onChange) {
    this.canvas = canvas
    this.onChange = onChange
    this.pointers = new Map()
    this.home(3)
    this.#listen()
  }

  /** The first view: from behind, above and a little to the right, around a point `ahead` metres in front of the camera. */
  home(ahead) {
    this.ahead = ahead
    this.yaw = -0.3
    this.pitch = 0.25
    this.distance = ahead * 1.6
    this.target = [0, 0, ahead]
    this.touched = false
    this.onChange()
  }

  /** Column-major matrix from metres to clip space, and how many px a metre at distance 1 has. */
  view(width, height) {
    const focal = 1 / Math.tan(FIELD_RAD / 2)
    const { right, down, forward } = this.#axes()
    const eye = this.target.map((value, i) => value - forward[i] * this.distance)
    const dot = axis => -(axis[0] * eye[0] + axis[1] * eye[1] + axis[2] * eye[2])
    const near = NEAREST_M
    const far = 300
    const a = (far + near) / (far - near)
    const b = -2 * far * near / (far - near)
    const sx = focal * height / width
    const rows = [
      [...right.map(value => value * sx), dot(right) * sx],
      [...down.map(value => -value * focal), -dot(down) * focal],
      [...forward.map(value => value * a), dot(forward) * a + b],
      [...forward, dot(forward)],
    ]
    const matrix = new Float32Array(16)
    for (let row = 0; row < 4; ++row) for (let column = 0; column < 4; ++column) matrix[column * 4 + row] = rows[row][column]
    return { matrix, pxPerMetre: focal * height / 2 }
  }

  #axes() {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)]
    const forward = [sy * cp, sp, cy * cp]
    const right = [cy, 0, -sy]
    const down = [-sy * sp, cp, -cy * sp]
    return { right, down, forward }
  }

  #turn(dx, dy) {
    this.yaw += dx
    this.pitch = Math.min(1.5, Math.max(-1.5, this.pitch + dy))
    this.#changed()
  }

  #zoom(factor) {
    this.distance = Math.min(100, Math.max(0.2, this.distance * factor))
    this.#changed()
  }

  #shift(dx, dy) {
    const { right, down } = this.#axes()
    const metres = this.distance * 2 * Math.tan(FIELD_RAD / 2) / this.canvas.clientHeight
    this.target = this.target.map((value, i) => value - (right[i] * dx + down[i] * dy) * metres)
    this.#changed()
  }

  #changed() {
    this.touched = true
    this.onChange()
  }

  #listen() {
    const canvas = this.canvas
    canvas.addEventListener('pointerdown', event => {
      canvas.setPointerCapture(event.pointerId)
      this.pointers.set(event.pointerId, event)
    })
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, event => this.pointers.delete(event.pointerId))
    canvas.addEventListener('pointermove', event => this.#drag(event))
    canvas.addEventListener('contextmenu', event => event.preventDefault())
    canvas.addEventListener('wheel', event => {
      // The page scrolls as usual until the cloud is in use.
      if (document.activeElement !== canvas) return
      event.preventDefault()
      this.#zoom(Math.exp(event.deltaY * 0.001))
    }, { passive: false })
    canvas.addEventListener('keydown', event => this.#onKey(event))
  }

  #drag(event) {
    const before = this.pointers.get(event.pointerId)
    if (!before) return
    const dx = event.clientX - before.clientX
    const dy = event.clientY - before.clientY
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1]
    this.pointers.set(event.pointerId, event)
    if (other) {
      const span = point => Math.hypot(point.clientX - other.clientX, point.clientY - other.clientY)
      this.#zoom(span(before) / Math.max(1, span(event)))
      this.#shift(dx / 2, dy / 2)
    } else if (event.shiftKey || event.buttons & 2) this.#shift(dx, dy)
    else this.#turn(-dx * 0.006, dy * 0.006)
  }

  #onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return
    const turns = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key]
    if (turns && event.shiftKey) this.#shift(turns[0] * 20, turns[1] * 20)
    else if (turns) this.#turn(turns[0] * 0.08, turns[1] * 0.08)
    else if (event.key === '+' || event.key === '=') this.#zoom(0.9)
    else if (event.key === '-') this.#zoom(1 / 0.9)
    else if (event.key === '0' || event.key === 'Home') this.home(this.ahead)
    else return
    event.preventDefault()
    event.stopPropagation()
  }
}
