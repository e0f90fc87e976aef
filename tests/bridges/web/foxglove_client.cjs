// SPDX-License-Identifier: Apache-2.0
//
// Foxglove's own client connects to a real disparity-web beside a real daemon, subscribes to each channel and compares
// what it decodes with what the C++ client reads of the same frame.
//   node foxglove_client.cjs DISPARITYD DISPARITY_WEB FRAME_VALUES
// Exit status: 0 all is right, 1 something differs, 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { spawn } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')
const readline = require('node:readline')
const { need, decoderOf, floats } = require('./foxglove_decoder.cjs')

const SUBPROTOCOLS = ['foxglove.sdk.v1', 'foxglove.websocket.v1']
const PATIENCE_MS = 60000
const TOPICS = ['/confidence', '/depth/error', '/depth/image_rect', '/depth/image_rect_raw', '/disparity',
  '/left/camera_info', '/left/image_rect', '/left/image_rect/compressed', '/points', '/right/camera_info', '/scan',
  '/status', '/tf']
const WITHOUT_STAMP = ['/status']

class Programs {
  constructor () {
    this.folder = fs.mkdtempSync(path.join(os.tmpdir(), 'foxglove-'))
    this.running = []
  }

  // Starts a program and returns it with an iterator over the lines of its output.
  start (program, args) {
    const child = spawn(program, args, { stdio: ['ignore', 'pipe', 'pipe'] })
    child.problems = ''
    child.stderr.on('data', text => { child.problems += text })
    child.lines = readline.createInterface({ input: child.stdout })[Symbol.asyncIterator]()
    this.running.push(child)
    return child
  }

  async end () {
    for (const child of this.running.reverse()) {
      if (child.exitCode === null && child.signalCode === null) {
        const ended = new Promise(resolve => child.once('exit', resolve))
        child.kill('SIGTERM')
        await ended
      }
    }
    fs.rmSync(this.folder, { recursive: true })
  }
}

async function nextLine (child) {
  const { value, done } = await child.lines.next()
  assert.ok(!done, `${child.spawnfile} has ended: ${child.problems}`)
  return value
}

// Follows a server as a viewer does, with Foxglove's client.
class Viewer {
  constructor (address, protocol, options = {}) {
    const { FoxgloveClient } = need('@foxglove/ws-protocol')
    const { WebSocket } = need('ws')
    this.socket = new WebSocket(address, [protocol], options)
    this.client = new FoxgloveClient({ ws: this.socket })
    this.channels = new Map() // by topic
    this.topics = new Map() // by subscription
    this.waiters = []
    this.statuses = []
    this.onMessage = () => {}
    this.client.on('serverInfo', info => { this.info = info; this.wake() })
    this.client.on('status', status => { this.statuses.push(status); this.wake() })
    this.client.on('error', error => { throw error })
    this.client.on('advertise', list => {
      list.forEach(channel => this.channels.set(channel.topic, { ...channel, decode: decoderOf(channel) }))
      this.wake()
    })
    this.client.on('unadvertise', ids => {
      for (const [topic, channel] of this.channels) {
        if (ids.includes(channel.id)) this.channels.delete(topic)
      }
      this.wake()
    })
    this.client.on('message', ({ subscriptionId, timestamp, data }) => {
      const topic = this.topics.get(subscriptionId)
      this.onMessage(topic, this.channels.get(topic).decode(data), timestamp)
      this.wake()
    })
  }

  wake () {
    this.waiters = this.waiters.filter(({ test, resolve }) => !test() || resolve() !== undefined)
  }

  // Waits for an event after which the test holds.
  until (what, test) {
    if (test()) return Promise.resolve()
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`${what}: not within ${PATIENCE_MS} ms`)), PATIENCE_MS)
      this.waiters.push({ test, resolve: () => { clearTimeout(timer); resolve() } })
    })
  }

  subscribe (topic) {
    this.topics.set(this.client.subscribe(this.channels.get(topic).id), topic)
  }

  close () {
    return new Promise(resolve => {
      this.socket.addEventListener('close', resolve)
      this.client.close()
    })
  }
}

const stampOf = header => BigInt(header.stamp.sec) * 1000000000n + BigInt(header.stamp.nanosec)

// Returns the numbers of a plane, row by row.
function plane (frame, name) {
  const bytes = Buffer.from(frame.planes[name], 'base64')
  const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength)
  return { disparity: Int16Array, depth: Uint16Array, depth_error: Uint16Array }[name]
    ? new { disparity: Int16Array, depth: Uint16Array, depth_error: Uint16Array }[name](copy)
    : new Uint8Array(copy)
}

// Compares two lists of numbers and names the first place where they differ.
function sameNumbers (found, wanted, what) {
  assert.strictEqual(found.length, wanted.length, what)
  for (let i = 0; i < wanted.length; ++i) {
    if (!Object.is(found[i], wanted[i])) assert.fail(`${what}[${i}]: ${found[i]}, expected ${wanted[i]}`)
  }
}

const metres = mm => mm === 0 ? NaN : mm === 65535 ? Infinity : Math.fround(mm / 1000)

// Calls a function for each point of a cloud that is taken of the image.
function forEachPoint (cloud, frame, call) {
  const step = Math.ceil(frame.width / cloud.width)
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength)
  for (let row = 0; row < cloud.height; ++row) {
    for (let column = 0; column < cloud.width; ++column) {
      const at = row * cloud.row_step + column * cloud.point_step
      const values = [0, 4, 8, 12].map(offset => view.getFloat32(at + offset, true))
      call(values, column * step, row * step)
    }
  }
}

const CHECKS = {
  '/left/image_rect' (message, frame) {
    assert.strictEqual(message.encoding, 'mono8')
    sameNumbers(message.data, plane(frame, 'left'), 'left')
  },
  '/left/image_rect/compressed' (message) {
    assert.strictEqual(message.format, 'jpeg')
    assert.deepStrictEqual([...message.data.slice(0, 2)], [0xff, 0xd8])
    assert.deepStrictEqual([...message.data.slice(-2)], [0xff, 0xd9])
  },
  '/confidence' (message, frame) {
    assert.strictEqual(message.encoding, 'mono8')
    sameNumbers(message.data, plane(frame, 'confidence'), 'confidence')
  },
  '/disparity' (message, frame) {
    const wanted = Array.from(plane(frame, 'disparity'), d => Math.fround(d / 16 + frame.disparity_offset))
    sameNumbers(floats(message.image), wanted, 'disparity')
    assert.strictEqual(message.f, Math.fround(frame.f))
    assert.strictEqual(message.t, Math.fround(frame.baseline_mm / 1000))
    assert.strictEqual(message.min_disparity, Math.fround(frame.d_min + frame.disparity_offset))
  },
  '/depth/image_rect_raw' (message, frame) {
    assert.strictEqual(message.encoding, '32FC1')
    sameNumbers(floats(message), Array.from(plane(frame, 'depth'), metres), 'depth')
  },
  '/depth/image_rect' (message, frame) {
    assert.strictEqual(message.encoding, '16UC1')
    sameNumbers(new Uint16Array(Uint8Array.from(message.data).buffer), plane(frame, 'depth'), 'depth')
  },
  '/depth/error' (message, frame) {
    sameNumbers(floats(message), Array.from(plane(frame, 'depth_error'), metres), 'depth error')
  },
  '/left/camera_info' (message, frame) {
    assert.deepStrictEqual([message.width, message.height], [frame.width, frame.height])
    assert.deepStrictEqual([...message.p],
      [frame.f, 0, frame.cx, 0, 0, frame.f, frame.cy, 0, 0, 0, 1, 0])
  },
  '/right/camera_info' (message, frame) {
    assert.deepStrictEqual([...message.p], [frame.f, 0, frame.cx + frame.disparity_offset,
      -frame.f * frame.baseline_mm / 1000, 0, frame.f, frame.cy, 0, 0, 0, 1, 0])
  },
  '/points' (message, frame) {
    const disparity = plane(frame, 'disparity')
    const left = plane(frame, 'left')
    let seen = 0
    forEachPoint(message, frame, ([x, y, z, intensity], column, row) => {
      const pixel = row * frame.width + column
      assert.strictEqual(intensity, left[pixel])
      const d = disparity[pixel] / 16 + frame.disparity_offset
      if (disparity[pixel] === frame.invalid || d <= 0) {
        assert.ok(Number.isNaN(x) && Number.isNaN(y) && Number.isNaN(z), `point ${column}, ${row}`)
        return
      }
      ++seen
      const wanted = frame.f * frame.baseline_mm / 1000 / d
      const near = (value, right) => assert.ok(Math.abs(value - right) <= 1e-6 * (1 + wanted), `${value}, ${right}`)
      near(z, wanted)
      near(x, (column - frame.cx) * wanted / frame.f)
      near(y, (row - frame.cy) * wanted / frame.f)
    })
    assert.ok(seen > 1000, `${seen} points have a place`)
  },
  '/scan' (message, frame) {
    const { sectors, max_m: most } = frame.scan
    const wanted = sectors.map(sector => sector.state === 'occupied' ? Math.fround(sector.distance_m)
      : sector.state === 'free' && sector.free_m >= most - 1e-6 ? Infinity : NaN)
    sameNumbers(message.ranges, wanted, 'ranges')
    sameNumbers(message.intensities, sectors.map(sector => sector.state === 'occupied' ? sector.confidence : 0),
      'intensities')
    const first = (sectors[0].from_deg + sectors[0].to_deg) / 2 * Math.PI / 180
    assert.ok(Math.abs(message.angle_min - first) < 1e-3, `${message.angle_min}, expected ${first}`)
    assert.ok(wanted.some(Number.isFinite), 'the scene has an obstacle')
  },
  '/tf' (message) {
    assert.strictEqual(message.transforms[0].header.frame_id, 'camera')
    assert.strictEqual(message.transforms[0].child_frame_id, 'left_camera')
  },
  '/status' (message) {
    assert.strictEqual(message.state, 'running')
    assert.strictEqual(message.synthetic, true)
    assert.ok(message.published > 0)
  },
}

// Adds an entry to a map and leaves out old ones: a frame has some megabytes, and the other side sees it soon or never.
function keep (map, key, value) {
  map.set(key, value)
  if (map.size > 40) map.delete(map.keys().next().value)
}

// Reads frames with the C++ client until each topic has had a message of one of them.
async function compare (viewer, frames) {
  const missing = new Set(TOPICS)
  const messages = new Map() // by stamp: a list of [topic, message]
  const references = new Map() // by stamp
  const check = stamp => {
    if (!references.has(stamp)) return
    for (const [topic, message] of messages.get(stamp) ?? []) {
      try {
        CHECKS[topic](message, references.get(stamp))
      } catch (error) {
        error.message = `${topic}: ${error.message}`
        throw error
      }
      missing.delete(topic)
    }
    messages.delete(stamp)
  }
  let problem = null
  viewer.onMessage = (topic, message, timestamp) => {
    try {
      if (WITHOUT_STAMP.includes(topic)) {
        CHECKS[topic](message)
        missing.delete(topic)
        return
      }
      const stamp = stampOf(message.header ?? message.transforms[0].header)
      assert.ok(timestamp >= stamp, 'a message is received after its capture')
      keep(messages, stamp, [...(messages.get(stamp) ?? []), [topic, message]])
      check(stamp)
    } catch (error) {
      problem = error
    }
  }
  const read = (async () => {
    while (missing.size > 0 && !problem) {
      const frame = JSON.parse(await nextLine(frames))
      keep(references, BigInt(frame.realtime_ns), frame)
      try {
        check(BigInt(frame.realtime_ns))
      } catch (error) {
        problem = error
      }
      viewer.wake()
    }
  })()
  TOPICS.forEach(topic => viewer.subscribe(topic))
  await Promise.race([read, viewer.until(`messages of ${[...missing]}`, () => problem || missing.size === 0)])
  if (problem) throw problem
  assert.strictEqual(missing.size, 0)
}

// A page that the server was not told of may not connect.
async function refuses (address, origin) {
  const { WebSocket } = need('ws')
  const socket = new WebSocket(address, SUBPROTOCOLS, { origin })
  const status = await new Promise((resolve, reject) => {
    socket.on('unexpected-response', (request, response) => { resolve(response.statusCode); request.destroy() })
    socket.on('open', () => reject(new Error(`${origin} may connect`)))
  })
  assert.strictEqual(status, 403)
}

async function main () {
  const [daemonProgram, webProgram, valuesProgram] = process.argv.slice(2)
  need('@foxglove/ws-protocol')
  need('ws')
  const programs = new Programs()
  try {
    const name = `foxglove-${process.pid}`
    const socket = path.join(programs.folder, 'socket')
    programs.start(daemonProgram, ['--source', 'scene:vga@15', '--name', name, '--set', `socket.unix=${socket}`,
      '--set', 'socket.tcp=', '--set', 'scan.enabled=true', '--set', 'match.depth_error=true'])
    const web = programs.start(webProgram, ['--name', name, '--socket', `unix:${socket}`, '--listen', '127.0.0.1:0',
      '--origin', 'file://'])
    const address = (await nextLine(web)).replace(/^http/, 'ws')
    await refuses(address, 'https://elsewhere.example')
    for (const protocol of SUBPROTOCOLS) {
      const viewer = new Viewer(address, protocol, { origin: 'file://' })
      await viewer.until('serverInfo', () => viewer.info)
      assert.strictEqual(viewer.socket.protocol, protocol)
      assert.strictEqual(viewer.info.name, 'disparityd')
      await viewer.until('channels', () => viewer.channels.size === TOPICS.length)
      assert.deepStrictEqual([...viewer.channels.keys()].sort(), TOPICS)
      const frames = programs.start(valuesProgram, [`unix:${socket}`])
      await compare(viewer, frames)
      viewer.socket.send('{"op":"getParameters"}')
      await viewer.until('a refusal', () => viewer.statuses.length > 0)
      assert.match(viewer.statuses[0].message, /"getParameters" is not supported/)
      await viewer.close()
      frames.kill('SIGTERM')
    }
    console.log(`${TOPICS.length} channels compared, over ${SUBPROTOCOLS.join(' and ')}`)
  } finally {
    await programs.end()
  }
}

main().catch(error => {
  console.error(error)
  process.exit(1)
})
