// SPDX-License-Identifier: Apache-2.0
//
// Compares the reader of MCAP and of ROS 2 messages, the product's writer and the one that the tests use, with npm's @mcap/core
// and @foxglove/rosmsg2-serialization: each reads what the other wrote, message for message, in every combination of features, and
// of what the product wrote all that is whole before a cut.
//   node other_mcap.cjs PROGRAM
// PROGRAM is mcap_messages. Exit status: 0 all is right, 1 something differs, 77 a package is missing.
'use strict'

const assert = require('node:assert')
const { execFileSync } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')

const need = require('../need_package.cjs')(
  '@mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 @foxglove/cdr@3.5.0')

const { McapWriter, McapStreamReader, McapIndexedReader, TempBuffer } = need('@mcap/core')
const { parse } = need('@foxglove/rosmsg')
const { MessageWriter } = need('@foxglove/rosmsg2-serialization')
const { CdrWriter, EncapsulationKind } = need('@foxglove/cdr')

const program = process.argv[2]
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'disparityd-mcap-'))
process.on('exit', () => fs.rmSync(folder, { recursive: true }))

const FEATURES = ['useChunks', 'useMessageIndex', 'useChunkIndex', 'useStatistics', 'useSummaryOffsets',
  'repeatSchemas', 'repeatChannels', 'useAttachmentIndex', 'useMetadataIndex']
const CONTENTS = ['NoData', 'OneMessage', 'TenMessages', 'OneAttachment', 'OneMetadata', 'OneSchemalessMessage']

const hex = bytes => Buffer.from(bytes).toString('hex')
const text = bytes => Buffer.from(bytes).toString('latin1')

// The programs of the systems unpack what this one packed.
function unpack (command) {
  return packed => execFileSync(command, ['-d', '-c'], { input: packed, maxBuffer: 1 << 28 })
}
const decompressHandlers = { zstd: unpack('zstd'), lz4: unpack('lz4') }

// Returns what PROGRAM reads from these files, by their names.
function read (files) {
  const found = new Map()
  for (let i = 0; i < files.length; i += 500) {
    const output = execFileSync(program, ['read', ...files.slice(i, i + 500)], { maxBuffer: 1 << 28 }).toString()
    for (const line of output.trim().split('\n')) {
      const file = JSON.parse(line)
      found.set(file.path, file)
    }
  }
  return found
}

function wanted (contents) {
  const count = contents === 'TenMessages' ? 10 : contents.endsWith('Message') ? 1 : 0
  return [...Array(count).keys()].map(i => ({ sequence: 10 + i, time: String(2 + i), data: hex([1, 2, i]) }))
}

async function write (contents, options) {
  const buffer = new TempBuffer()
  const writer = new McapWriter({ writable: buffer, chunkSize: 60, ...options })
  await writer.start({ profile: '', library: '' })
  if (contents === 'OneAttachment') {
    await writer.addAttachment(
      { name: 'myFile', logTime: 2n, createTime: 1n, mediaType: 'text/plain', data: new Uint8Array([1, 2, 3]) })
  } else if (contents === 'OneMetadata') {
    await writer.addMetadata({ name: 'myMetadata', metadata: new Map([['foo', 'bar']]) })
  } else if (contents !== 'NoData') {
    const schemaId = contents === 'OneSchemalessMessage'
      ? 0
      : await writer.registerSchema({ name: 'Example', encoding: 'c', data: new Uint8Array([4, 5, 6]) })
    const channelId = await writer.registerChannel(
      { schemaId, topic: 'example', messageEncoding: 'a', metadata: new Map([['foo', 'bar']]) })
    for (const message of wanted(contents)) {
      const time = BigInt(message.time)
      await writer.addMessage({ channelId, sequence: message.sequence, logTime: time, publishTime: time,
        data: Buffer.from(message.data, 'hex') })
    }
  }
  await writer.end()
  return buffer.get()
}

async function theirsIsRead () {
  const files = new Map()
  for (const contents of CONTENTS) {
    for (let choice = 0; choice < 1 << FEATURES.length; ++choice) {
      const options = Object.fromEntries(FEATURES.map((name, bit) => [name, (choice >> bit & 1) === 1]))
      const file = path.join(folder, `theirs-${contents}-${choice}.mcap`)
      fs.writeFileSync(file, await write(contents, options))
      files.set(file, { contents, options })
    }
  }
  const found = read([...files.keys()])
  for (const [file, { contents, options }] of files) {
    const messages = found.get(file).messages
    assert.deepStrictEqual(messages.map(({ sequence, log, publish, data }) => ({ sequence, log, publish, data })),
      wanted(contents).map(({ sequence, time, data }) => ({ sequence, log: time, publish: time, data })), file)
    for (const message of messages) {
      assert.strictEqual(message.topic, 'example')
      assert.strictEqual(message.encoding, 'a')
      assert.deepStrictEqual(message.schema,
        contents === 'OneSchemalessMessage' ? undefined : ['Example', 'c', '\x04\x05\x06'])
    }
    const known = contents.endsWith('Message') || contents.endsWith('Messages')
    const complete = options.repeatChannels && (options.repeatSchemas || contents === 'OneSchemalessMessage')
    assert.strictEqual(found.get(file).summary, known && complete, file)
  }
  return files.size
}

function isSame (file, contents, records) {
  const messages = records.filter(record => record.type === 'Message')
  assert.deepStrictEqual(
    messages.map(({ sequence, logTime, publishTime, data }) =>
      ({ sequence, time: String(logTime), publish: String(publishTime), data: hex(data) })),
    wanted(contents).map(message => ({ ...message, publish: message.time })), file)
}

// What is whole in front of a cut, for a reader that goes on while bytes come: messages in order, and of a file cut later not fewer.
function cutIsRead (file, contents, bytes) {
  let before = 0
  for (let size = 8; size <= bytes.length; size += 41) {
    const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers })
    reader.append(bytes.subarray(0, size))
    const messages = []
    for (let record; (record = reader.nextRecord());) if (record.type === 'Message') messages.push(hex(record.data))
    assert.deepStrictEqual(messages, wanted(contents).slice(0, messages.length).map(({ data }) => data), `${file} ${size}`)
    assert.ok(messages.length >= before, `${file} ${size}`)
    before = messages.length
  }
  assert.strictEqual(before, wanted(contents).length, file)
}

async function oursIsRead () {
  const lines = execFileSync(program, ['write', folder], { maxBuffer: 1 << 28 }).toString().trim().split('\n')
  for (const line of lines) {
    const { path: file, contents, choice, product } = JSON.parse(line)
    const bytes = fs.readFileSync(file)
    const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers })
    reader.append(bytes)
    const records = []
    for (let record; (record = reader.nextRecord());) records.push(record)
    assert.ok(reader.done(), file)
    isSame(file, contents, records)
    if (product) cutIsRead(file, contents, bytes)
    for (const schema of records.filter(record => record.type === 'Schema')) {
      assert.deepStrictEqual([schema.id, schema.name, schema.encoding, text(schema.data)],
        [1, 'Example', 'c', '\x04\x05\x06'])
    }
    for (const channel of records.filter(record => record.type === 'Channel')) {
      assert.deepStrictEqual([channel.topic, channel.messageEncoding], ['example', 'a'])
    }
    const attachment = records.find(record => record.type === 'Attachment')
    assert.strictEqual(attachment === undefined ? undefined : hex(attachment.data),
      contents === 'OneAttachment' ? '010203' : undefined)
    const metadata = records.find(record => record.type === 'Metadata')
    assert.strictEqual(metadata?.metadata.get('foo'), contents === 'OneMetadata' ? 'bar' : undefined)
    // Their other reader goes by the indexes: chunks, both indexes, channels and schemas once more.
    if ((choice & 0b11000111) === 0b11000111 && wanted(contents).length > 0) await isIndexed(file, contents, bytes)
  }
  return lines.length
}

async function isIndexed (file, contents, bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length)))
  }
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers })
  const records = []
  for await (const message of reader.readMessages({ validateCrcs: true })) records.push(message)
  isSame(file, contents, records)
}

const DEFINITION = `# all kinds
std_msgs/Header header
bool yes
byte[4] four
int8[] few
uint16 GREY=1
uint16 small 7
int64 large
float32 real
float64[9] k
float64[] d
string<=20 name "left"
string[] names
Part part
Part[<=3] parts
Nothing nothing
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: test_msgs/Part
uint8 a
float64 b
================================================================================
MSG: test_msgs/Nothing
int32 ONLY=1
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
`
const NUMBERS = [1, 2, 3, 4, 5, 6, 7, 8, 9]
const VALUE = {
  header: { stamp: { sec: 1700000000, nanosec: 5 }, frame_id: 'left' },
  yes: true,
  four: [1, 2, 3, 4],
  few: [-1, 2],
  small: 513,
  large: -5n,
  real: 0.5,
  k: NUMBERS,
  d: [],
  name: 'right',
  names: ['a', 'bc'],
  part: { a: 3, b: -2.25 },
  parts: [{ a: 1, b: 1 }, { a: 2, b: 2 }],
  nothing: {}
}
const FIELDS = {
  'header.stamp.sec': 1700000000,
  'header.stamp.nanosec': 5,
  'header.frame_id': 'left',
  yes: 1,
  four: '01020304',
  few: 'ff02',
  small: 513,
  large: -5,
  real: 0.5,
  k: NUMBERS,
  d: [],
  name: 'right',
  'part.a': 3,
  'part.b': -2.25,
  'parts.0.a': 1,
  'parts.0.b': 1,
  'parts.1.a': 2,
  'parts.1.b': 2
}

// The same message by hand, as their writer knows one byte order only.
function bigEndian () {
  const cdr = new CdrWriter({ kind: EncapsulationKind.CDR_BE })
  cdr.int32(1700000000).uint32(5).string('left').uint8(1)
  for (const value of VALUE.four) cdr.uint8(value)
  cdr.sequenceLength(2).int8(-1).int8(2).uint16(513).int64(-5n).float32(0.5)
  for (const value of VALUE.k) cdr.float64(value)
  cdr.sequenceLength(0).string('right').sequenceLength(2).string('a').string('bc')
  cdr.uint8(3).float64(-2.25).sequenceLength(2).uint8(1).float64(1).uint8(2).float64(2)
  return cdr.uint8(0).data
}

async function messagesAreRead () {
  const buffer = new TempBuffer()
  const writer = new McapWriter({ writable: buffer })
  await writer.start({ profile: 'ros2', library: '' })
  const schemaId = await writer.registerSchema(
    { name: 'test_msgs/msg/All', encoding: 'ros2msg', data: Buffer.from(DEFINITION) })
  const channelId = await writer.registerChannel(
    { schemaId, topic: '/all', messageEncoding: 'cdr', metadata: new Map() })
  const little = new MessageWriter(parse(DEFINITION, { ros2: true })).writeMessage(VALUE)
  for (const data of [little, bigEndian()]) {
    await writer.addMessage({ channelId, sequence: 0, logTime: 1n, publishTime: 1n, data })
  }
  await writer.end()
  const file = path.join(folder, 'messages.mcap')
  fs.writeFileSync(file, buffer.get())
  const { messages } = read([file]).get(file)
  assert.strictEqual(messages.length, 2)
  for (const message of messages) assert.deepStrictEqual(message.fields, FIELDS)
}

async function main () {
  const theirs = await theirsIsRead()
  const ours = await oursIsRead()
  await messagesAreRead()
  console.log(`${theirs} files of theirs and ${ours} of ours are read alike`)
}

main().catch(error => {
  console.error(error)
  process.exit(1)
})
