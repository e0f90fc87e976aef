// SPDX-License-Identifier: Apache-2.0
//
// Reads the SVO2 files that the tests make with npm's @mcap/core, and finds in them what they were made of.
//   node other_svo2.cjs PROGRAM
// PROGRAM is svo2_files. Exit status: 0 all is right, 1 something differs, 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { execFileSync } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')

const { McapStreamReader } = require('../need_package.cjs')('@mcap/core@2.2.2')('@mcap/core')

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'disparityd-svo2-'))
process.on('exit', () => fs.rmSync(folder, { recursive: true }))

// The programs of the systems unpack what this one packed.
function unpack (command) {
  return packed => execFileSync(command, ['-d', '-c'], { input: packed, maxBuffer: 1 << 28 })
}
const decompressHandlers = { zstd: unpack('zstd'), lz4: unpack('lz4') }

// Returns the messages of each topic.
function read (bytes) {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers })
  reader.append(bytes)
  const topics = new Map()
  const messages = new Map()
  for (let record; (record = reader.nextRecord());) {
    if (record.type === 'Channel') {
      topics.set(record.id, record.topic)
      if (!messages.has(record.topic)) messages.set(record.topic, [])
    } else if (record.type === 'Message') {
      messages.get(topics.get(record.channelId)).push({ time: record.logTime, data: Buffer.from(record.data) })
    }
  }
  assert.ok(reader.done())
  return messages
}

const base64 = text => Buffer.from(text, 'base64')

function headerIsRight (wanted, name, messages) {
  assert.strictEqual(messages.length, 1)
  const json = JSON.parse(messages[0].data)
  const fields = base64(json.header)
  const width = name === 'width-of-one-eye' ? wanted.width / 2 : wanted.width
  assert.deepStrictEqual([0, 4, 8, 12].map(place => fields.readUInt32LE(place)),
    [width, wanted.height, wanted.serial, wanted.rate])
  const matrix = base64(json.Calib_acc)
  assert.deepStrictEqual([...Array(18).keys()].map(i => matrix.readFloatLE(4 * i)),
    [1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1])
  assert.strictEqual(json.imu_frequency_hz, wanted.imu_frequency_hz)
}

function videoIsRight (wanted, messages) {
  assert.strictEqual(messages.length, wanted.frames.length)
  let lastKey = 0
  messages.forEach(({ time, data }, i) => {
    const payload = data.readUInt32LE(4)
    assert.deepStrictEqual([data.readUInt32LE(0), payload], [data.length - 4, data.length - 64])
    const below = data.subarray(data.length - 56)
    assert.strictEqual(String(time), wanted.times[i])
    assert.strictEqual(String(below.readBigUInt64LE(0x18) * BigInt(wanted.unit)), wanted.times[i])
    assert.strictEqual(below.readUInt32LE(0x20), payload)
    if (below.readInt32LE(0x24) === 3) lastKey = wanted.frames[i]
    assert.strictEqual(below.readInt32LE(0x28), lastKey)
    assert.strictEqual(below.readInt32LE(0x30), wanted.frames[i])
  })
}

function samplesAreRight (wanted, messages) {
  assert.strictEqual(messages.length, wanted.samples)
  messages.forEach(({ time, data }, i) => {
    const sample = base64(JSON.parse(data).data)
    assert.strictEqual(sample.length, 360)
    assert.strictEqual(sample.readBigUInt64LE(0x10) * BigInt(wanted.unit), time)
    const turn = i % 16
    const floats = place => [0, 4, 8].map(offset => sample.readFloatLE(place + offset))
    assert.deepStrictEqual(floats(0x58), [0.5 * turn, -0.25 * turn, 90])
    assert.deepStrictEqual(floats(0x64), [0.125 * turn, 9.75, -0.5])
  })
}

const lines = execFileSync(process.argv[2], [folder], { maxBuffer: 1 << 28 }).toString().trim().split('\n')
let sound = 0
for (const line of lines) {
  const wanted = JSON.parse(line)
  const name = path.basename(wanted.path, '.svo2')
  const messages = read(fs.readFileSync(wanted.path))
  const of = topic => messages.get(topic) ?? []
  if (!wanted.sound) continue
  if (name !== 'no-header') headerIsRight(wanted, name, of('svo_header'))
  assert.strictEqual(of('svo_header').length, name === 'no-header' ? 0 : 1)
  assert.strictEqual(of('svo_footer').length, name === 'no-footer' ? 0 : 1)
  videoIsRight(wanted, of(`Camera_SN${wanted.serial}/side_by_side`))
  samplesAreRight(wanted, of(`Camera_SN${wanted.serial}/sensors`))
  ++sound
}
assert.ok(sound > 20)
console.log(`${lines.length} made files are MCAP, ${sound} of them hold what they were made of`)
