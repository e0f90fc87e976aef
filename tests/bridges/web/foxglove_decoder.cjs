// SPDX-License-Identifier: Apache-2.0
//
// Decodes what a server of Foxglove's protocol sends, with Foxglove's own npm packages and the schemas that the server
// advertises. For the tests beside it.
'use strict'

const path = require('node:path')

const PACKAGES = '@foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 @foxglove/ws-protocol@0.8.0 ws@8.23.0'

// Loads a package. Without it the test is skipped: exit status 77.
function need (name) {
  const folder = process.env.DISPARITYD_NODE_MODULES
  try {
    return require(folder ? path.resolve(folder, name) : name)
  } catch (error) {
    if (error.code !== 'MODULE_NOT_FOUND') throw error
    console.log(`skipped: no ${name}; npm install --prefix FOLDER ${PACKAGES} and set ` +
      'DISPARITYD_NODE_MODULES=FOLDER/node_modules')
    process.exit(77)
  }
}

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
