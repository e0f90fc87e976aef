// SPDX-License-Identifier: Apache-2.0
//
// Reads a grey PNG of 8 or 16 bits, not interlaced: all that /snapshot.png makes of raw values. A browser would cut 16 bits to 8.
'use strict'

const assert = require('node:assert')
const zlib = require('node:zlib')

const SIGNATURE = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a])

function paeth(left, up, corner) {
  const [a, b, c] = [Math.abs(up - corner), Math.abs(left - corner), Math.abs(left + up - 2 * corner)]
  return a <= b && a <= c ? left : b <= c ? up : corner
}

/** Undoes a row's filter in place: `row` holds bytes after the filter's number, `above` the finished row before it. */
function unfilter(filter, row, above, step) {
  for (let i = 0; i < row.length; ++i) {
    const left = i >= step ? row[i - step] : 0
    const corner = i >= step ? above[i - step] : 0
    row[i] += [0, left, above[i], (left + above[i]) >> 1, paeth(left, above[i], corner)][filter]
  }
}

/** Returns { width, height, values }: values row by row. */
function readGreyPng(bytes) {
  assert.ok(bytes.subarray(0, 8).equals(SIGNATURE), 'this is no PNG')
  let head = null
  const parts = []
  for (let at = 8; at < bytes.length;) {
    const length = bytes.readUInt32BE(at)
    const data = bytes.subarray(at + 8, at + 8 + length)
    const type = bytes.toString('latin1', at + 4, at + 8)
    if (type === 'IHDR') head = { width: data.readUInt32BE(0), height: data.readUInt32BE(4), bits: data[8], colour: data[9], interlaced: data[12] }
    if (type === 'IDAT') parts.push(data)
    at += 12 + length
  }
  assert.deepStrictEqual([head.colour, head.interlaced], [0, 0], 'grey, not interlaced')
  const step = head.bits / 8
  const rowBytes = head.width * step
  const packed = zlib.inflateSync(Buffer.concat(parts))
  const values = []
  let above = Buffer.alloc(rowBytes)
  for (let y = 0; y < head.height; ++y) {
    const start = y * (rowBytes + 1)
    const row = packed.subarray(start + 1, start + 1 + rowBytes)
    unfilter(packed[start], row, above, step)
    for (let x = 0; x < head.width; ++x) values.push(step === 2 ? row.readUInt16BE(2 * x) : row[x])
    above = row
  }
  return { width: head.width, height: head.height, bits: head.bits, values }
}

module.exports = { readGreyPng }
