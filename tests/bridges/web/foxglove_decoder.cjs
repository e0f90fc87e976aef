// SPDX-License-Identifier: Apache-2.0
//
// Decodes what a server of Foxglove's protocol sends, with Foxglove's own npm packages and the schemas that the server
// advertises. For the tests beside it.
'use strict'

const need = require('../../need_package.cjs')(
  '@foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 @foxglove/ws-protocol@0.8.0 ws@8.23.0')

// Returns a function that turns the bytes of a channel's messages into an object.
function decoderOf (channel) {
  if (channel.encoding === 'json') {
    return bytes => JSON.parse(Buffer.from(bytes.buffer, bytes.byteOffset, bytes.byteLength).toString('utf8'))
  }
  if (channel.encoding !== 'cdr' || channel.schemaEncoding !== 'ros2msg') {
    throw new Error(`${channel.topic}: ${channel.encoding}, ${channel.schemaEncoding}`)
  }
  const { parse } = need('@foxglove/rosmsg')
  const { MessageReader } = need('@foxglove/rosmsg2-serialization')
  const reader = new MessageReader(parse(channel.schema, { ros2: true }))
  return bytes => reader.readMessage(bytes)
}

// Returns the numbers of an image of 32FC1.
function floats (image) {
  return new Float32Array(Uint8Array.from(image.data).buffer)
}

module.exports = { need, decoderOf, floats }
