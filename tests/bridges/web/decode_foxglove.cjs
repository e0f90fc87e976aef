// SPDX-License-Identifier: Apache-2.0
//
// Decodes what a session of the bridge sends with Foxglove's own npm packages, and compares every field.
//   node decode_foxglove.cjs PROGRAM
// PROGRAM is foxglove_messages; tests/bridges/ros_messages/message_frames.cpp has the values. Exit status: 0 all is right, 1 something differs,
// 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { execFileSync } = require('node:child_process')
const { need, decoderOf, floats } = require('./foxglove_decoder.cjs')

const WIDTH = 8
const HEIGHT = 4
const PIXELS = [...Array(WIDTH * HEIGHT).keys()]
const STAMP = { sec: 1700000000, nanosec: 123456789 }
const LATER = { sec: 1700000000, nanosec: 125956789 }
const RECEIVED = 1700000000163456789n
const LEFT = { stamp: STAMP, frame_id: 'left_camera' }
const F = 100
const OFFSET = 0.25

const disparity = i => i === 0 ? -1 : i === 1 ? -0.25 : (16 * i + i % 16) / 16
const depth = i => i === 0 ? NaN : i === 1 ? Infinity : Math.fround((1000 + i) / 1000)
const depthOfDisparity = i => i === 0 ? NaN : i === 1 ? Infinity : Math.fround(F * 0.12 / (disparity(i) + OFFSET))

// Turns typed arrays into plain ones, and checks that the message has these fields and no other.
function same (message, wanted) {
  const plain = value => ArrayBuffer.isView(value) ? Array.from(value)
    : Array.isArray(value) ? value.map(plain)
      : value !== null && typeof value === 'object'
        ? Object.fromEntries(Object.entries(value).map(([key, field]) => [key, plain(field)]))
        : value
  assert.deepStrictEqual(plain(message), wanted)
}

function image (message, encoding, bytesPerPixel) {
  same({ ...message, data: message.data.length },
    { header: LEFT, height: HEIGHT, width: WIDTH, encoding, is_bigendian: 0, step: WIDTH * bytesPerPixel,
      data: WIDTH * HEIGHT * bytesPerPixel })
}

function bytesImage (message, encoding, values) {
  image(message, encoding, values.length / PIXELS.length)
  assert.deepStrictEqual(Array.from(message.data), values)
}

function floatImage (message, value) {
  image(message, '32FC1', 4)
  assert.deepStrictEqual(Array.from(floats(message)), PIXELS.map(value))
}

function jpeg (message) {
  same({ ...message, data: [...message.data.slice(0, 2), ...message.data.slice(-2)] },
    { header: LEFT, format: 'jpeg', data: [0xff, 0xd8, 0xff, 0xd9] })
}

function cameraInfo (message, cx, shift) {
  same(message, {
    header: LEFT, height: HEIGHT, width: WIDTH, distortion_model: 'plumb_bob', d: [0, 0, 0, 0, 0],
    k: [F, 0, cx, 0, F, 1.5, 0, 0, 1], r: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    p: [F, 0, cx, shift, 0, F, 1.5, 0, 0, 0, 1, 0], binning_x: 0, binning_y: 0,
    roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false },
  })
}

function depthMm (message) {
  image(message, '16UC1', 2)
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength)
  assert.deepStrictEqual(PIXELS.map(i => view.getUint16(2 * i, true)),
    PIXELS.map(i => i === 0 ? 0 : i === 1 ? 65535 : 1000 + i))
}

function disparityImage (message) {
  floatImage(message.image, i => Math.fround(disparity(i) + OFFSET))
  same({ ...message, image: null }, {
    header: LEFT, image: null, f: F, t: Math.fround(0.12),
    valid_window: { x_offset: 0, y_offset: 0, height: HEIGHT, width: WIDTH, do_rectify: false },
    min_disparity: 0.25, max_disparity: 63.25, delta_d: 0.0625,
  })
}

function points (message, paintName, paint) {
  const field = (name, index) => ({ name, offset: 4 * index, datatype: 7, count: 1 })
  same({ ...message, data: message.data.length }, {
    header: LEFT, height: HEIGHT, width: WIDTH,
    fields: ['x', 'y', 'z', paintName].map(field), is_bigendian: false, point_step: 16, row_step: 16 * WIDTH,
    data: 16 * PIXELS.length, is_dense: false,
  })
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength)
  for (const i of PIXELS) {
    const z = depthOfDisparity(i)
    const [column, row] = [i % WIDTH, Math.floor(i / WIDTH)]
    const place = Number.isFinite(z)
      ? [Math.fround((column - 3.5) * z / F), Math.fround((row - 1.5) * z / F), z]
      : [NaN, NaN, NaN]
    assert.deepStrictEqual([0, 4, 8].map(at => view.getFloat32(16 * i + at, true)), place, `point ${i}`)
    paint(view, 16 * i + 12, i)
  }
}

function scan (message) {
  const radians = degrees => Math.fround(degrees * Math.PI / 180)
  same(message, {
    header: { stamp: STAMP, frame_id: 'camera_footprint' },
    angle_min: radians(-10), angle_max: radians(20), angle_increment: radians(10), time_increment: 0, scan_time: 0,
    range_min: 0.5, range_max: 10, ranges: [2.5, Infinity, NaN, NaN], intensities: [200, 0, 0, 0],
  })
}

// Rotates a vector by a quaternion.
function rotated (q, [x, y, z]) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
  const axis = [q.x, q.y, q.z]
  const once = cross(axis, [x, y, z])
  const twice = cross(axis, once)
  return [x, y, z].map((value, i) => value + 2 * (q.w * once[i] + twice[i]))
}

function transforms (message) {
  const [transform] = message.transforms
  assert.strictEqual(message.transforms.length, 1)
  same(transform.header, { stamp: STAMP, frame_id: 'camera' })
  assert.strictEqual(transform.child_frame_id, 'left_camera')
  same(transform.transform.translation, { x: 0, y: 0, z: 0 })
  const to = axis => rotated(transform.transform.rotation, axis)
  assert.deepStrictEqual(to([0, 0, 1]), [1, 0, 0], 'ahead is x')
  assert.deepStrictEqual(to([1, 0, 0]), [0, -1, 0], 'right is -y')
  assert.deepStrictEqual(to([0, 1, 0]), [0, 0, -1], 'down is -z')
}

function imu (message, stamp, rate, acceleration) {
  same(message, {
    header: { stamp, frame_id: 'camera_imu' },
    orientation: { x: 0, y: 0, z: 0, w: 1 }, orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0],
    angular_velocity: rate, angular_velocity_covariance: Array(9).fill(0),
    linear_acceleration: acceleration, linear_acceleration_covariance: Array(9).fill(0),
  })
}

function magneticField (message) {
  const near = (value, wanted) => assert.ok(Math.abs(value - wanted) < 1e-15, `${value}, expected ${wanted}`)
  near(message.magnetic_field.x, 20e-6)
  near(message.magnetic_field.y, -30e-6)
  near(message.magnetic_field.z, 40e-6)
  same({ ...message, magnetic_field: null }, {
    header: { stamp: STAMP, frame_id: 'camera_imu' }, magnetic_field: null,
    magnetic_field_covariance: Array(9).fill(0),
  })
}

function scalar (message, stamp, frame, name, value) {
  same(message, { header: { stamp, frame_id: frame }, [name]: value, variance: 0 })
}

function status (message) {
  assert.strictEqual(message.state, 'running')
  assert.strictEqual(message.source, 'scene:vga@15')
  assert.strictEqual(message.synthetic, true)
  assert.strictEqual(message.rate, 14.5)
  assert.strictEqual(message.published, 4321)
  assert.strictEqual(message.geometry.baseline_mm, 120)
  assert.strictEqual(message.steps[0].p90_us, 1234.5)
  assert.deepStrictEqual(message.notices, ['a notice'])
}

const grey = (view, at, i) => assert.strictEqual(view.getFloat32(at, true), 7 * i)
const colour = (view, at, i) => assert.strictEqual(view.getUint32(at, true), ((255 - i) << 16) | (2 * i << 8) | i)
const rgb = PIXELS.flatMap(i => [255 - i, 2 * i, i])

// What comes, in this order: topic, check.
const EXPECTED = [
  // The frame with a grey image: by subscription.
  ['/left/image_rect', message => bytesImage(message, 'mono8', PIXELS.map(i => 7 * i))],
  ['/left/image_rect/compressed', jpeg],
  ['/left/camera_info', message => cameraInfo(message, 3.5, 0)],
  ['/right/camera_info', message => cameraInfo(message, 3.75, -12)],
  ['/disparity', disparityImage],
  ['/depth/image_rect_raw', message => floatImage(message, depth)],
  ['/depth/error', message => floatImage(message, i => i < 2 ? depth(i) : Math.fround((10 + i) / 1000))],
  ['/confidence', message => bytesImage(message, 'mono8', PIXELS)],
  ['/points', message => points(message, 'intensity', grey)],
  ['/scan', scan],
  ['/tf', transforms],
  ['/depth/image_rect', depthMm],
  // The sensors: each sample by subscription.
  ['/imu', message => imu(message, STAMP, { x: 0.5, y: -0.25, z: 0.125 }, { x: 0.75, y: -9.75, z: 1.5 })],
  ['/magnetic_field', magneticField],
  ['/temperature/imu', message => scalar(message, STAMP, 'camera_imu', 'temperature', 36.5)],
  ['/temperature/camera', message => scalar(message, STAMP, 'camera', 'temperature', 41.25)],
  ['/temperature/left', message => scalar(message, STAMP, 'camera', 'temperature', 33.5)],
  ['/temperature/right', message => scalar(message, STAMP, 'camera', 'temperature', 34.25)],
  ['/pressure', message => scalar(message, STAMP, 'camera', 'fluid_pressure', 101325)],
  ['/humidity', message => scalar(message, STAMP, 'camera', 'relative_humidity', 0.455)],
  ['/imu', message => imu(message, LATER, { x: 1, y: 2, z: 3 }, { x: 4, y: 5, z: 6 })],
  ['/temperature/imu', message => scalar(message, LATER, 'camera_imu', 'temperature', 37)],
  ['/status', status],
  // The frame with a coloured image and disparities alone.
  ['/left/image_rect', message => bytesImage(message, 'rgb8', rgb)],
  ['/left/image_rect/compressed', jpeg],
  ['/left/camera_info', message => cameraInfo(message, 3.5, 0)],
  ['/right/camera_info', message => cameraInfo(message, 3.75, -12)],
  ['/disparity', disparityImage],
  ['/depth/image_rect_raw', message => floatImage(message, depthOfDisparity)],
  ['/points', message => points(message, 'rgb', colour)],
  ['/tf', transforms],
]

const GONE = ['/confidence', '/depth/error', '/depth/image_rect', '/humidity', '/imu', '/magnetic_field', '/pressure', '/scan',
  '/temperature/camera', '/temperature/imu', '/temperature/left', '/temperature/right']

// Follows texts and messages as a viewer does.
class Viewer {
  constructor () {
    this.channels = new Map()
    this.seen = 0
  }

  text (message) {
    switch (message.op) {
      case 'serverInfo':
        assert.deepStrictEqual(message, { op: 'serverInfo', name: 'disparityd', capabilities: [], supportedEncodings: [],
          metadata: { version: '1.2.3' }, sessionId: 'one' })
        break
      case 'advertise':
        for (const channel of message.channels) {
          assert.ok(!this.channels.has(channel.id))
          this.channels.set(channel.id, { topic: channel.topic, decode: decoderOf(channel) })
        }
        break
      case 'unadvertise':
        assert.deepStrictEqual(message.channelIds.map(id => this.channels.get(id).topic).sort(), GONE)
        message.channelIds.forEach(id => this.channels.delete(id))
        break
      default:
        assert.fail(JSON.stringify(message))
    }
  }

  // The subscription's id is 100 more than the channel's.
  binary (message) {
    const { subscriptionId, timestamp, data } = message
    const channel = this.channels.get(subscriptionId - 100)
    const [topic, check] = EXPECTED[this.seen++]
    assert.strictEqual(channel.topic, topic)
    assert.strictEqual(timestamp, RECEIVED)
    try {
      check(channel.decode(data))
    } catch (error) {
      error.message = `${topic}, message ${this.seen}: ${error.message}`
      throw error
    }
  }
}

// The npm client reads a binary message only from a socket, so its head is read here.
function parsed (hexadecimal) {
  const bytes = Buffer.from(hexadecimal, 'hex')
  assert.strictEqual(bytes[0], 1)
  return {
    subscriptionId: bytes.readUInt32LE(1),
    timestamp: bytes.readBigUInt64LE(5),
    data: Uint8Array.from(bytes.subarray(13)),
  }
}

function main () {
  need('@foxglove/rosmsg')
  need('@foxglove/rosmsg2-serialization')
  const viewer = new Viewer()
  for (const line of execFileSync(process.argv[2]).toString().trim().split('\n')) {
    const blank = line.indexOf(' ')
    const rest = line.slice(blank + 1)
    line.startsWith('text ') ? viewer.text(JSON.parse(rest)) : viewer.binary(parsed(rest))
  }
  assert.strictEqual(viewer.seen, EXPECTED.length)
  console.log(`${viewer.seen} messages decoded`)
}

main()
