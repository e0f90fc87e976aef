// SPDX-License-Identifier: Apache-2.0
//
// Reads a file of disparityctl export, and one that disparityctl record --mcap makes of a daemon, with npm's @mcap/core, every
// checksum compared, and each message by the definition in the file with @foxglove/rosmsg2-serialization.
//   node read_export.cjs DISPARITYCTL [DISPARITYD]
// Exit status: 0 all is right, 1 something differs, 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { execFileSync, spawn } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')

const need = require('../need_package.cjs')('@mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0')
const { McapIndexedReader } = need('@mcap/core')
const { parse } = need('@foxglove/rosmsg')
const { MessageReader } = need('@foxglove/rosmsg2-serialization')

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'disparityd-export-'))
process.on('exit', () => fs.rmSync(folder, { recursive: true }))
const unpack = packed => execFileSync('zstd', ['-d', '-c'], { input: packed, maxBuffer: 1 << 28 })

const WIDTH = 128
const HEIGHT = 96
const FRAMES = 3

function makeFile () {
  const file = path.join(folder, 'scene.mcap')
  execFileSync(process.argv[2], ['export', `scene:vga@30?width=${WIDTH}&height=${HEIGHT}&loop=4`, '--frames', String(FRAMES),
    '--mcap', file, '--disparities', '16', '--contents', 'raw,rectified,disparity,depth,depth-mm,points,scan,tf'],
  { stdio: ['ignore', 'ignore', 'inherit'] })
  return fs.readFileSync(file)
}

/// The raw pair and the disparities of a daemon.
function recordFile () {
  const file = path.join(folder, 'daemon.mcap')
  const socket = path.join(folder, 'd.sock')
  const name = `other-mcap-${process.pid}`
  const daemon = spawn(process.argv[3], ['--source', `scene:vga@30?width=${WIDTH}&height=${HEIGHT}&loop=4`, '--name', name, '--set', `socket.unix=${socket}`,
    '--set', 'socket.tcp=', '--set', 'match.disparities=16', '--set', 'rectify.raw=true'], { stdio: 'ignore' })
  try {
    for (let tries = 0; ; ++tries) { // until it has drawn its scene
      try {
        execFileSync(process.argv[2], ['record', '--mcap', file, '--frames', String(FRAMES), '--contents', 'raw,disparity,tf', '--name', name,
          '--socket', `unix:${socket}`], { stdio: 'pipe' })
        return fs.readFileSync(file)
      } catch (error) {
        if (tries === 600) {
          throw error
        }
        Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 100)
      }
    }
  } finally {
    daemon.kill()
  }
}

const IMAGES = {
  '/stereo/left/image_raw': ['yuv422_yuy2', 2],
  '/stereo/right/image_raw': ['yuv422_yuy2', 2],
  '/stereo/left/image_rect_color': ['rgb8', 3],
  '/stereo/right/image_rect_color': ['rgb8', 3],
  '/stereo/depth/image_rect': ['32FC1', 4],
  '/stereo/depth/image_rect_raw': ['16UC1', 2]
}

const RAW_OF_DAEMON = {
  '/stereo/left/image_raw': ['mono8', 1],
  '/stereo/right/image_raw': ['mono8', 1]
}

/// K and D are those of a lens, R turns, and P of the right camera has the baseline.
function checkRawInfo (topic, message) {
  assert.strictEqual(message.header.frame_id, 'stereo_left_raw_optical_frame')
  assert.strictEqual(message.distortion_model, { 5: 'plumb_bob', 8: 'rational_polynomial' }[message.d.length])
  assert.ok(message.d.some(value => value !== 0) && message.k[0] > 0 && message.k[0] !== message.p[0])
  for (const row of [0, 3, 6]) {
    assert.ok(Math.abs(message.r[row] ** 2 + message.r[row + 1] ** 2 + message.r[row + 2] ** 2 - 1) < 1e-9)
  }
  assert.ok((message.p[3] < 0) === topic.includes('/right/'))
}

function checkMessage (images, topic, message, logTime) {
  const header = topic === '/tf_static' ? message.transforms[0].header : message.header
  assert.strictEqual(BigInt(header.stamp.sec) * 1000000000n + BigInt(header.stamp.nanosec), logTime, topic)
  if (images[topic]) {
    const [encoding, bytes] = images[topic]
    assert.deepStrictEqual([message.width, message.height, message.encoding, message.step, message.data.length],
      [WIDTH, HEIGHT, encoding, bytes * WIDTH, bytes * WIDTH * HEIGHT], topic)
  } else if (topic.endsWith('/camera_info')) {
    assert.deepStrictEqual([message.width, message.height], [WIDTH, HEIGHT])
    assert.ok(message.k[0] > 0 && message.p[0] > 0 && (message.p[3] < 0) === topic.includes('/right/'), topic)
  } else if (topic === '/stereo/disparity') {
    assert.ok(message.f > 0 && message.t > 0 && message.image.data.length === 4 * WIDTH * HEIGHT)
  } else if (topic === '/stereo/points2') {
    assert.strictEqual(message.data.length, message.point_step * WIDTH * HEIGHT)
  } else if (topic === '/tf_static') {
    const robot = images === IMAGES ? ['stereo_link'] : [] // scans are placed there
    assert.deepStrictEqual(message.transforms.map(transform => transform.child_frame_id).sort(),
      ['stereo_left_optical_frame', 'stereo_left_raw_optical_frame', ...robot, 'stereo_right_optical_frame'])
  }
}

/// Returns how many messages each topic has.
async function check (bytes, images) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length)))
  }
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: { zstd: unpack } })
  assert.strictEqual(reader.header.profile, 'ros2')
  const readers = new Map()
  for (const schema of reader.schemasById.values()) {
    assert.strictEqual(schema.encoding, 'ros2msg')
    readers.set(schema.id, new MessageReader(parse(Buffer.from(schema.data).toString(), { ros2: true })))
  }
  const counts = {}
  let all = 0n
  for await (const { channelId, logTime, data } of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(channelId)
    const message = readers.get(channel.schemaId).readMessage(data)
    checkMessage(images, channel.topic, message, logTime)
    if (images === RAW_OF_DAEMON && channel.topic.endsWith('/camera_info')) {
      checkRawInfo(channel.topic, message)
    }
    counts[channel.topic] = (counts[channel.topic] ?? 0) + 1
    ++all
  }
  assert.strictEqual(reader.statistics.messageCount, all)
  console.log(`${all} messages are read alike`)
  return counts
}

async function main () {
  const counts = await check(makeFile(), IMAGES)
  const expected = [...Object.keys(IMAGES), '/stereo/left/camera_info', '/stereo/right/camera_info', '/stereo/depth/camera_info',
    '/stereo/disparity', '/stereo/points2', '/stereo/scan']
  assert.deepStrictEqual(counts, Object.fromEntries([['/tf_static', 1], ...expected.map(topic => [topic, FRAMES])]))
  if (process.argv[3]) {
    const recorded = await check(recordFile(), RAW_OF_DAEMON)
    const frames = recorded['/stereo/disparity']
    assert.ok(frames >= FRAMES)
    const raw = [...Object.keys(RAW_OF_DAEMON), '/stereo/left/camera_info', '/stereo/right/camera_info', '/stereo/disparity']
    assert.deepStrictEqual(recorded, Object.fromEntries([['/tf_static', 1], ...raw.map(topic => [topic, frames])]))
  }
}

main().catch(error => {
  console.error(error)
  process.exit(1)
})
