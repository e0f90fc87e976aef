// SPDX-License-Identifier: Apache-2.0
//
// Decodes messages of random and extreme frames with Foxglove's npm packages, and compares every field with what follows
// from the frame. Computes the hashes of the types from their definitions, too.
//   node decode_messages.cjs PROGRAM
// PROGRAM is ros_random_messages. Exit status: 0 all is right, 1 something differs, 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { execFileSync } = require('node:child_process')
const { createHash } = require('node:crypto')
const need = require('../../need_package.cjs')('@foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0')

const { readGreyPng } = require('../web/png.cjs')

const { parse } = need('@foxglove/rosmsg')
const { MessageReader } = need('@foxglove/rosmsg2-serialization')

// The numbers of products and contents, as proto/disparity.proto and bridges/ros_messages/contents.h have them.
const PRODUCT = { disparity: 1, confidence: 2, depth: 3, left: 4, leftColour: 5, depthError: 7, right: 8, rightColour: 9 }
const CONTENT = {
  leftImage: 1, leftJpeg: 2, leftInfo: 3, rightInfo: 4, disparity: 5, depth: 6, depthError: 7, confidence: 8, points: 9, scan: 10,
  transforms: 11, imu: 12, magneticField: 13, imuTemperature: 14, cameraTemperature: 15, leftTemperature: 16, rightTemperature: 17,
  pressure: 18, humidity: 19, depthMm: 21, rightImage: 22, leftGrey: 23, rightGrey: 24, clock: 26,
  compressedDepth: 27,
}

// REP-2011: the numbers of types.
const TYPE = { uint8: 3, int32: 6, uint32: 7, float32: 10, float64: 11, bool: 15, byte: 16, string: 17 }

const full = name => name.replace('/', '/msg/')

// A line of a definition: "uint8[16] data".
function fieldOf (line) {
  const [, type, isArray, length, name] = /^([\w/]+)(\[(\d*)\])? (\w+)$/.exec(line)
  const array = isArray === undefined ? 0 : length === '' ? 144 : 48
  const nested = type.includes('/')
  return `{"name": "${name}", "type": {"type_id": ${(nested ? 1 : TYPE[type]) + array}, "capacity": ${length || 0}, ` +
    `"string_capacity": 0, "nested_type_name": "${nested ? full(type) : ''}"}}`
}

function description (name, text) {
  const fields = text.trim().split('\n').filter(line => !line.includes('=')).map(fieldOf)
  return `{"type_name": "${name}", "fields": [${fields.join(', ')}]}`
}

function hashOf (name, schema) {
  const [own, ...others] = schema.split('='.repeat(80) + '\nMSG: ')
  const referenced = others.map(other => [full(other.slice(0, other.indexOf('\n'))), other.slice(other.indexOf('\n'))])
    .sort(([a], [b]) => a < b ? -1 : 1)
  const text = `{"type_description": ${description(name, own)}, "referenced_type_descriptions": [` +
    `${referenced.map(([other, definition]) => description(other, definition)).join(', ')}]}`
  return 'RIHS01_' + createHash('sha256').update(text).digest('hex')
}

// What ROS 2 itself computed, as others have published it: the hashes above are computed in the right way.
const PUBLISHED = {
  'sensor_msgs/msg/Image': 'RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47',
  'sensor_msgs/msg/CameraInfo': 'RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275',
  'sensor_msgs/msg/CompressedImage': 'RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a',
  'sensor_msgs/msg/PointCloud2': 'RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5',
  'sensor_msgs/msg/Imu': 'RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b',
  'sensor_msgs/msg/MagneticField': 'RIHS01_e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff',
  'rosgraph_msgs/msg/Clock': 'RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564',
}

function checkHashes (definitions) {
  const hashes = {}
  for (const { name, schema, hash } of Object.values(definitions)) {
    assert.strictEqual(hash, hashOf(name, schema), name)
    hashes[name] = hash
  }
  for (const [name, hash] of Object.entries(PUBLISHED)) {
    assert.strictEqual(hashes[name], hash, name)
  }
}

// Turns typed arrays into plain ones.
const plain = value => ArrayBuffer.isView(value) ? Array.from(value)
  : Array.isArray(value) ? value.map(plain)
    : value !== null && typeof value === 'object'
      ? Object.fromEntries(Object.entries(value).map(([key, field]) => [key, plain(field)]))
      : value
const same = (message, wanted) => assert.deepStrictEqual(plain(message), wanted)

function stampOf (text) {
  const ns = BigInt(text)
  const second = 1000000000n
  const rest = ((ns % second) + second) % second
  return { sec: Number((ns - rest) / second), nanosec: Number(rest) }
}

class Frame {
  constructor (json) {
    Object.assign(this, json)
    this.stamp = stampOf(json.realtime_ns)
    this.header = { stamp: this.stamp, frame_id: 'l' }
    this.indices = [...Array(this.width * this.height).keys()]
    this.calibrated = this.f > 0 && this.baseline_mm > 0
  }

  bytes (product) {
    return this.planes[product] === undefined ? null : Buffer.from(this.planes[product], 'hex')
  }

  has (product) {
    return this.planes[product] !== undefined
  }

  millimetres (product) {
    const bytes = this.bytes(product)
    return this.indices.map(i => bytes.readUInt16LE(2 * i))
      .map(mm => mm === 0 ? NaN : mm === 65535 ? Infinity : Math.fround(Math.fround(mm) / Math.fround(1000)))
  }

  sixteenths () {
    const bytes = this.bytes(PRODUCT.disparity)
    return this.indices.map(i => bytes.readInt16LE(2 * i))
  }

  metresOfDisparities () {
    return this.sixteenths().map(d => {
      const shift = d / 16 + this.offset
      return d === this.invalid ? NaN : shift <= 0 ? Infinity : Math.fround(this.f * this.baseline_mm / 1000 / shift)
    })
  }

  // The depths, from the first of two products that serves.
  depths (first) {
    for (const product of first === PRODUCT.depth ? [PRODUCT.depth, PRODUCT.disparity] : [PRODUCT.disparity, PRODUCT.depth]) {
      if (this.has(product) && product === PRODUCT.depth) return this.millimetres(product)
      if (this.has(product) && this.calibrated) return this.metresOfDisparities()
    }
    return null
  }
}

function image (frame, message, encoding, data) {
  same({ ...message, data: null }, { header: frame.header, height: frame.height, width: frame.width, encoding, is_bigendian: 0,
    step: frame.width * data.length / (frame.width * frame.height), data: null })
  assert.ok(Buffer.compare(Buffer.from(message.data), data) === 0, encoding)
}

const floats = numbers => Buffer.from(Float32Array.from(numbers).buffer)

// Bytes of floats without the signs and payloads of NaN, which nobody is promised.
function floatImage (frame, message, numbers) {
  image(frame, { ...message, data: floats(new Float32Array(Uint8Array.from(message.data).buffer)) }, '32FC1', floats(numbers))
}

// RVL (Wilson 2017): a number is 3 bits of each nibble, the lowest first; nibbles lie in words from the highest bits on.
function readRvl (bytes, count) {
  let at = 0
  const nibble = () => bytes[(at >> 3) * 4 + 3 - ((at & 7) >> 1)] >> (at++ & 1 ? 0 : 4) & 15
  const number = () => {
    const first = nibble()
    return first < 8 ? first : first - 8 + 8 * number()
  }
  const values = []
  for (let last = 0; values.length < count;) {
    for (let zeros = number(); zeros > 0; --zeros) values.push(0)
    for (let others = number(); others > 0; --others) {
      const code = number()
      last += code & 1 ? -(code + 1) / 2 : code / 2
      values.push(last)
    }
  }
  assert.strictEqual(Math.ceil(at / 8) * 4, bytes.length)
  return values
}

function compressedDepth (frame, message) {
  const data = Buffer.from(message.data)
  const rvl = message.format === '16UC1; compressedDepth rvl'
  same({ ...message, data: [...data.subarray(0, 12)] },
    { header: frame.header, format: rvl ? message.format : '16UC1; compressedDepth png', data: Array(12).fill(0) })
  const { width, height, values } = rvl
    ? { width: data.readUInt32LE(12), height: data.readUInt32LE(16), values: readRvl(data.subarray(20), frame.indices.length) }
    : readGreyPng(data.subarray(12))
  assert.deepStrictEqual([width, height], [frame.width, frame.height])
  const depths = frame.bytes(PRODUCT.depth)
  assert.deepStrictEqual(values, frame.indices.map(i => depths.readUInt16LE(2 * i)))
}

function rgbOf (bgr) {
  const rgb = Buffer.from(bgr)
  for (let i = 0; i < rgb.length; i += 3) [rgb[i], rgb[i + 2]] = [bgr[i + 2], bgr[i]]
  return rgb
}

function eye (frame, message, colour, grey) {
  frame.has(colour) ? image(frame, message, 'rgb8', rgbOf(frame.bytes(colour))) : image(frame, message, 'mono8', frame.bytes(grey))
}

function cameraInfo (frame, message, right) {
  const cx = frame.cx + (right ? frame.offset : 0)
  same(message, {
    header: frame.header, height: frame.height, width: frame.width, distortion_model: 'plumb_bob', d: [0, 0, 0, 0, 0],
    k: [frame.f, 0, cx, 0, frame.f, frame.cy, 0, 0, 1], r: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    p: [frame.f, 0, cx, right ? -frame.f * frame.baseline_mm / 1000 : 0, 0, frame.f, frame.cy, 0, 0, 0, 1, 0],
    binning_x: 0, binning_y: 0, roi: { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false },
  })
}

function disparityImage (frame, message) {
  floatImage(frame, message.image, frame.sixteenths().map(d => Math.fround(d / 16 + frame.offset)))
  const first = frame.d_min + frame.offset
  same({ ...message, image: null }, {
    header: frame.header, image: null, f: Math.fround(frame.f), t: Math.fround(frame.baseline_mm / 1000),
    valid_window: { x_offset: 0, y_offset: 0, height: frame.height, width: frame.width, do_rectify: false },
    min_disparity: Math.fround(first), max_disparity: Math.fround(first + frame.disparities - 1), delta_d: 0.0625,
  })
}

function points (frame, message) {
  const colour = frame.bytes(PRODUCT.leftColour)
  const grey = frame.bytes(PRODUCT.left)
  const names = ['x', 'y', 'z', ...(colour ? ['rgb'] : grey ? ['intensity'] : [])]
  const size = 4 * names.length
  same({ ...message, data: message.data.length }, {
    header: frame.header, height: frame.height, width: frame.width,
    fields: names.map((name, i) => ({ name, offset: 4 * i, datatype: 7, count: 1 })), is_bigendian: false, point_step: size,
    row_step: size * frame.width, data: size * frame.indices.length, is_dense: false,
  })
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength)
  const z = frame.depths(PRODUCT.disparity)
  for (const i of frame.indices) {
    const place = Number.isFinite(z[i])
      ? [Math.fround((i % frame.width - frame.cx) * z[i] / frame.f),
          Math.fround((Math.floor(i / frame.width) - frame.cy) * z[i] / frame.f), z[i]]
      : [NaN, NaN, NaN]
    assert.deepStrictEqual([0, 4, 8].map(at => view.getFloat32(size * i + at, true)), place, `point ${i}`)
    if (colour) assert.strictEqual(view.getUint32(size * i + 12, true), colour.readUIntLE(3 * i, 3))
    else if (grey) assert.strictEqual(view.getFloat32(size * i + 12, true), grey[i])
  }
}

// For each content: whether a frame has the message, and its check.
const OF_FRAMES = new Map([
  [CONTENT.leftImage, [f => f.has(PRODUCT.leftColour) || f.has(PRODUCT.left), (f, m) => eye(f, m, PRODUCT.leftColour, PRODUCT.left)]],
  [CONTENT.rightImage, [f => f.has(PRODUCT.rightColour) || f.has(PRODUCT.right),
    (f, m) => eye(f, m, PRODUCT.rightColour, PRODUCT.right)]],
  [CONTENT.leftGrey, [f => f.has(PRODUCT.left), (f, m) => image(f, m, 'mono8', f.bytes(PRODUCT.left))]],
  [CONTENT.rightGrey, [f => f.has(PRODUCT.right), (f, m) => image(f, m, 'mono8', f.bytes(PRODUCT.right))]],
  [CONTENT.leftJpeg, [f => f.has(PRODUCT.leftColour) || f.has(PRODUCT.left),
    (f, m) => same({ ...m, data: [...m.data.slice(0, 2), ...m.data.slice(-2)] },
      { header: f.header, format: 'jpeg', data: [0xff, 0xd8, 0xff, 0xd9] })]],
  [CONTENT.leftInfo, [f => f.calibrated && f.flags === 0, (f, m) => cameraInfo(f, m, false)]],
  [CONTENT.rightInfo, [f => f.calibrated && f.flags === 0, (f, m) => cameraInfo(f, m, true)]],
  [CONTENT.disparity, [f => f.has(PRODUCT.disparity), disparityImage]],
  [CONTENT.depth, [f => f.depths(PRODUCT.depth) !== null, (f, m) => floatImage(f, m, f.depths(PRODUCT.depth))]],
  [CONTENT.depthMm, [f => f.has(PRODUCT.depth), (f, m) => image(f, m, '16UC1', f.bytes(PRODUCT.depth))]],
  [CONTENT.compressedDepth, [f => f.has(PRODUCT.depth), compressedDepth]],
  [CONTENT.depthError, [f => f.has(PRODUCT.depthError), (f, m) => floatImage(f, m, f.millimetres(PRODUCT.depthError))]],
  [CONTENT.confidence, [f => f.has(PRODUCT.confidence), (f, m) => image(f, m, 'mono8', f.bytes(PRODUCT.confidence))]],
  [CONTENT.points, [f => f.f > 0 && f.depths(PRODUCT.disparity) !== null, points]],
  [CONTENT.transforms, [() => true, (f, m) => same(m, { transforms: [{ header: { stamp: f.stamp, frame_id: 'c' }, child_frame_id: 'l',
    transform: { translation: { x: 0, y: 0, z: 0 }, rotation: { x: -0.5, y: 0.5, z: -0.5, w: 0.5 } } }] })]],
  [CONTENT.clock, [() => true, (f, m) => same(m, { clock: f.stamp })]],
])

const vector = ([x, y, z]) => ({ x, y, z })
const scalar = (field, value, frame) => (s, m) => same(m, { header: { stamp: s.stamp, frame_id: frame }, [field]: value(s), variance: 0 })

const OF_SAMPLES = new Map([
  [CONTENT.imu, (s, m) => same(m, { header: { stamp: s.stamp, frame_id: 'i' }, orientation: { x: 0, y: 0, z: 0, w: 1 },
    orientation_covariance: [-1, 0, 0, 0, 0, 0, 0, 0, 0], angular_velocity: vector(s.rate), angular_velocity_covariance: Array(9).fill(0),
    linear_acceleration: vector(s.acceleration), linear_acceleration_covariance: Array(9).fill(0) })],
  [CONTENT.magneticField, (s, m) => same(m, { header: { stamp: s.stamp, frame_id: 'i' },
    magnetic_field: vector(s.field.map(value => value * 1e-6)), magnetic_field_covariance: Array(9).fill(0) })],
  [CONTENT.imuTemperature, scalar('temperature', s => s.imu_celsius, 'i')],
  [CONTENT.cameraTemperature, scalar('temperature', s => s.celsius, 'c')],
  [CONTENT.leftTemperature, scalar('temperature', s => s.left_celsius, 'c')],
  [CONTENT.rightTemperature, scalar('temperature', s => s.right_celsius, 'c')],
  [CONTENT.pressure, scalar('fluid_pressure', s => s.hectopascal * 100, 'c')],
  [CONTENT.humidity, scalar('relative_humidity', s => s.humidity / 100, 'c')],
])

function main () {
  const [first, ...lines] = execFileSync(process.argv[2], { maxBuffer: 1 << 28 }).toString().trim().split('\n').map(JSON.parse)
  checkHashes(first.definitions)
  const readers = Object.fromEntries(Object.entries(first.definitions)
    .map(([content, { schema }]) => [content, new MessageReader(parse(schema, { ros2: true }))]))
  const decode = (content, hexadecimal) => readers[content].readMessage(Uint8Array.from(Buffer.from(hexadecimal, 'hex')))
  const seen = {}
  lines.forEach((line, number) => {
    const frame = line.frame && new Frame(line.frame)
    const sample = line.sample && { ...line.sample, stamp: stampOf(line.sample.realtime_ns) }
    const wanted = frame ? [...OF_FRAMES].filter(([, [has]]) => has(frame)).map(([content]) => content) : [...OF_SAMPLES.keys()]
    assert.deepStrictEqual(Object.keys(line.messages).map(Number), wanted.sort((a, b) => a - b), `line ${number}`)
    for (const content of wanted) {
      seen[content] = (seen[content] ?? 0) + 1
      try {
        const message = decode(content, line.messages[content])
        frame ? OF_FRAMES.get(content)[1](frame, message) : OF_SAMPLES.get(content)(sample, message)
      } catch (error) {
        error.message = `line ${number}, content ${content}: ${error.message}`
        throw error
      }
    }
  })
  assert.strictEqual(Object.keys(seen).length, OF_FRAMES.size + OF_SAMPLES.size, 'some content never came')
  console.log(`${Object.values(seen).reduce((sum, count) => sum + count, 0)} messages decoded`)
}

main()
