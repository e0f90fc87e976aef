// SPDX-License-Identifier: Apache-2.0
//
// The point cloud, drawn by WebGL 2 from a grid of depths. The graphics processor computes each point from its pixel, so a frame costs
// one upload of its depths. It is drawn again only for a new frame or another view.

import { TURBO } from './turbo.js'
import { Orbit } from './orbit.js'
import { make, write } from './text.js'

const SLOW_PAUSE_MS = 300
const FARTHEST_M = 1e4
const FRAMES_M = [1, 2, 5, 10, 20] // distances at which the edge of the image is drawn

const POINTS = `#version 300 es
precision highp float;
in uint depth;
uniform mat4 view;
uniform ivec2 grid;
uniform vec2 size;
uniform float stride, f, pxPerMetre;
uniform vec2 centre;
uniform int byDepth;
uniform vec4 range; // near, far, and the same two in the quantity that the colours are linear in
uniform bool inverse;
uniform sampler2D left;
uniform sampler2D map;
out vec3 colour;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = 0.0;
  if (depth == 0u || depth == 65535u) return;
  float z = float(depth) * 0.001;
  // The middle of the block whose nearest depth this is.
  vec2 px = vec2(gl_VertexID % grid.x, gl_VertexID / grid.x) * stride + 0.5 * (stride - 1.0);
  gl_Position = view * vec4((px - centre) * z / f, z, 1.0);
  gl_PointSize = clamp(1.2 * stride * z / f * pxPerMetre / gl_Position.w, 1.0, 40.0);
  if (byDepth == 1) {
    float value = inverse ? 1.0 / z : z;
    float t = clamp((value - range.w) / (range.z - range.w), 0.0, 1.0);
    colour = texture(map, vec2((t * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  } else {
    colour = texture(left, (px + 0.5) / size).rgb;
  }
}`
const POINT_COLOUR = `#version 300 es
precision mediump float;
in vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1.0); }`
const LINES = `#version 300 es
in vec3 place;
uniform mat4 view;
void main() { gl_Position = view * vec4(place, 1.0); }`
const LINE_COLOUR = `#version 300 es
precision mediump float;
uniform vec4 colour;
out vec4 pixel;
void main() { pixel = colour; }`

export class Cloud {
  #gl
  #points
  #lines
  #frame = null // { header, step, width, height } of what is uploaded
  #corners = 0
  #asked = false
  #pauseMs = 0 // the least time between two frames that are shown
  #shownAt = -Infinity
  #labels = []
  #shown = { byDepth: false, range: null, image: 'depth' }

  constructor(root) {
    this.root = root
    this.canvas = root.querySelector('canvas')
    this.empty = root.querySelector('.no-picture')
    this.#gl = this.canvas.getContext('webgl2', { antialias: true, failIfMajorPerformanceCaveat: true })
    if (!this.#gl) {
      // No graphics processor: the points are drawn by the processor, which then has little time for the pictures.
      this.#gl = this.canvas.getContext('webgl2', { antialias: false })
      this.#pauseMs = SLOW_PAUSE_MS
    }
    if (!this.#gl) return this.say('This browser has no WebGL 2, which the point cloud needs.')
    this.orbit = new Orbit(this.canvas, () => this.#redraw())
    this.#prepare()
    this.canvas.addEventListener('webglcontextlost', event => event.preventDefault())
    this.canvas.addEventListener('webglcontextrestored', () => this.#prepare())
    new ResizeObserver(() => this.#redraw()).observe(this.canvas)
  }

  get usable() {
    return Boolean(this.#gl)
  }

  say(text) {
    write(this.empty, text)
    this.root.classList.toggle('stale', text !== '')
  }

  home() {
    if (this.usable) this.orbit.home(this.orbit.ahead)
  }

  /** How points are coloured: by the left image, or by depth with the colours of an image ('disparity' or 'depth') and a range. */
  colour(byDepth, range, image) {
    this.#shown = { byDepth, range, image }
    this.#redraw()
  }

  /** Takes a frame's depths (see frame.js; null without a calibration) and its left picture, a bitmap or null. */
  show(header, cloud, left) {
    if (!this.usable || this.#gl.isContextLost()) return
    if (!cloud) return this.say('Without a calibration there are no metres, so no points.')
    this.say('')
    const now = performance.now()
    if (now < this.#shownAt + this.#pauseMs) return
    this.#shownAt = now
    const gl = this.#gl
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#points.buffer)
    gl.bufferData(gl.ARRAY_BUFFER, cloud.depths, gl.STREAM_DRAW)
    if (left) {
      gl.bindTexture(gl.TEXTURE_2D, this.#points.left)
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, left)
    }
    if (!this.orbit.touched) this.#look(cloud.depths)
    this.#frameLines(header)
    this.#frame = { header, step: cloud.step, width: cloud.width, height: cloud.height }
    this.canvas.dataset.points = cloud.depths.length
    this.#redraw()
  }

  /** Puts the first view around the middle of what is seen, once it has moved far from there. */
  #look(depths) {
    const some = []
    for (let i = 0; i < depths.length; i += 7) if (depths[i] && depths[i] !== 65535) some.push(depths[i])
    if (some.length < 10) return
    const middle = some.sort((a, b) => a - b)[some.length >> 1] / 1000
    if (Math.abs(Math.log(middle / this.orbit.ahead)) > 0.2) this.orbit.home(middle)
  }

  #prepare() {
    const gl = this.#gl
    const texture = filter => {
      const made = gl.createTexture()
      gl.bindTexture(gl.TEXTURE_2D, made)
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter)
      for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE)
      return made
    }
    this.#points = { ...program(gl, POINTS, POINT_COLOUR, 'depth'), left: texture(gl.LINEAR), map: null }
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 1, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array([160, 170, 180]))
    this.#points.map = texture(gl.NEAREST)
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1)
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, 256, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, TURBO)
    gl.bindVertexArray(this.#points.array)
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#points.buffer)
    gl.enableVertexAttribArray(0)
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_SHORT, 0, 0)
    this.#lines = program(gl, LINES, LINE_COLOUR, 'place')
    gl.bindVertexArray(this.#lines.array)
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#lines.buffer)
    gl.enableVertexAttribArray(0)
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0)
    gl.enable(gl.DEPTH_TEST)
    gl.enable(gl.BLEND)
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA)
  }

  /** Lines: the edges of what the camera sees, and the edge of the image at some distances. */
  #frameLines(header) {
    const same = ['f', 'cx', 'cy', 'width', 'height'].every(name => this.#frame?.header[name] === header[name])
    if (same) return
    const corner = (x, y, z) => [(x - header.cx) * z / header.f, (y - header.cy) * z / header.f, z]
    const corners = z => [corner(0, 0, z), corner(header.width, 0, z), corner(header.width, header.height, z), corner(0, header.height, z)]
    const places = corners(FRAMES_M.at(-1)).flatMap(place => [[0, 0, 0], place])
    for (const z of FRAMES_M) corners(z).forEach((place, i, all) => places.push(place, all[(i + 1) % 4]))
    this.#corners = places.length
    const gl = this.#gl
    gl.bindBuffer(gl.ARRAY_BUFFER, this.#lines.buffer)
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(places.flat()), gl.STATIC_DRAW)
    for (const label of this.#labels) label.element.remove()
    this.#labels = FRAMES_M.map(z => ({ place: corner(header.width, header.height, z), element: make('span', { className: 'distance', textContent: `${z} m` }) }))
    this.root.append(...this.#labels.map(label => label.element))
  }

  #redraw() {
    if (this.#asked || !this.#gl) return
    this.#asked = true
    requestAnimationFrame(() => {
      this.#asked = false
      this.#draw()
    })
  }

  #draw() {
    const gl = this.#gl
    const { clientWidth, clientHeight } = this.canvas
    if (!this.#frame || !clientWidth || gl.isContextLost()) return
    const width = this.canvas.width = Math.round(clientWidth * devicePixelRatio)
    const height = this.canvas.height = Math.round(clientHeight * devicePixelRatio)
    const { matrix, pxPerMetre } = this.orbit.view(width, height)
    gl.viewport(0, 0, width, height)
    gl.clearColor(0, 0, 0, 0)
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT)
    this.#drawPoints(matrix, pxPerMetre)
    gl.useProgram(this.#lines.program)
    gl.bindVertexArray(this.#lines.array)
    gl.uniformMatrix4fv(this.#lines.at('view'), false, matrix)
    gl.uniform4f(this.#lines.at('colour'), 0.5, 0.65, 0.8, 0.45)
    gl.drawArrays(gl.LINES, 0, this.#corners)
    this.#placeLabels(matrix, clientWidth, clientHeight)
  }

  #drawPoints(matrix, pxPerMetre) {
    const gl = this.#gl
    const { header, step, width, height } = this.#frame
    const { byDepth, range, image } = this.#shown
    const at = this.#points.at
    gl.useProgram(this.#points.program)
    gl.bindVertexArray(this.#points.array)
    gl.activeTexture(gl.TEXTURE0)
    gl.bindTexture(gl.TEXTURE_2D, this.#points.left)
    gl.activeTexture(gl.TEXTURE1)
    gl.bindTexture(gl.TEXTURE_2D, this.#points.map)
    gl.activeTexture(gl.TEXTURE0)
    gl.uniform1i(at('left'), 0)
    gl.uniform1i(at('map'), 1)
    gl.uniformMatrix4fv(at('view'), false, matrix)
    gl.uniform2i(at('grid'), width, height)
    gl.uniform2f(at('size'), header.width, header.height)
    gl.uniform1f(at('stride'), step)
    gl.uniform1f(at('f'), header.f)
    gl.uniform2f(at('centre'), header.cx, header.cy)
    gl.uniform1f(at('pxPerMetre'), pxPerMetre)
    const inverse = image === 'disparity'
    const [near, end] = range ?? [0.5, 10]
    const far = Math.min(end, FARTHEST_M)
    gl.uniform1i(at('byDepth'), byDepth && range ? 1 : 0)
    gl.uniform1i(at('inverse'), inverse ? 1 : 0)
    gl.uniform4f(at('range'), near, far, inverse ? 1 / near : near, inverse ? 1 / far : far)
    gl.drawArrays(gl.POINTS, 0, width * height)
  }

  #placeLabels(m, width, height) {
    for (const { place: [x, y, z], element } of this.#labels) {
      const w = m[3] * x + m[7] * y + m[11] * z + m[15]
      const px = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2 * width
      const py = (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2 * height
      element.hidden = w < 0.1 || px < 0 || py < 0 || px > width - 30 || py > height - 14
      if (!element.hidden) element.style.transform = `translate(${px.toFixed(1)}px, ${py.toFixed(1)}px)`
    }
  }
}

/** Builds a program with one attribute and a buffer for it. */
function program(gl, vertex, fragment, attribute) {
  const made = gl.createProgram()
  for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type)
    gl.shaderSource(shader, text)
    gl.compileShader(shader)
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader))
    gl.attachShader(made, shader)
  }
  gl.bindAttribLocation(made, 0, attribute)
  gl.linkProgram(made)
  const places = new Map()
  const at = name => places.get(name) ?? places.set(name, gl.getUniformLocation(made, name)).get(name)
  return { program: made, at, array: gl.createVertexArray(), buffer: gl.createBuffer() }
}
