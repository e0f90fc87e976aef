// SPDX-License-Identifier: Apache-2.0
//
// Takes a binary message of /live apart: a header in JSON, then images and the depths of the point cloud. Nothing is drawn here.

import { colourRaw } from './colours.js'

const ARRAYS = { u8: Uint8Array, bgr8: Uint8Array, i16: Int16Array, u16: Uint16Array }

/** Unpacks zlib. Throws where the bytes are damaged. */
async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))
  return new Response(stream).arrayBuffer()
}

async function decodeImage(image, bytes, header) {
  if (image.encoding === 'jpeg') return { ...image, raw: null, bitmap: await createImageBitmap(new Blob([bytes], { type: 'image/jpeg' })) }
  const raw = new ARRAYS[image.type](await inflate(bytes))
  return { ...image, raw, bitmap: await createImageBitmap(colourRaw(image, raw, header)) }
}

async function decodeCloud(cloud, bytes) {
  return { ...cloud, depths: new Uint16Array(await inflate(bytes)) }
}

/** Reads the header alone: cheap, for a frame that will not be drawn. */
export function headerOf(buffer) {
  const length = new DataView(buffer).getUint32(0, true)
  return JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)))
}

/**
 * Decodes a message. Returns { header, images: { name: { bitmap, raw, width, height, ... } }, cloud }: raw is null for JPEG, cloud where
 * none was sent. The caller closes the bitmaps. Throws where something is damaged.
 */
export async function decode(buffer) {
  const header = headerOf(buffer)
  const start = 4 + new DataView(buffer).getUint32(0, true)
  const part = piece => new Uint8Array(buffer, start + piece.offset, piece.bytes)
  const [images, cloud] = await Promise.all([
    Promise.all((header.images ?? []).map(image => decodeImage(image, part(image), header))),
    header.cloud ? decodeCloud(header.cloud, part(header.cloud)) : null,
  ])
  return { header, images: Object.fromEntries(images.map(image => [image.name, image])), cloud }
}

/**
 * The values of a pixel of the whole image from raw images, as far as there are some: { disparity_px, depth_m, confidence,
 * depth_error_m }, each missing where its image is not here raw.
 */
export function rawValues(frame, x, y) {
  const values = {}
  const at = name => {
    const image = frame.images[name]
    if (!image?.raw) return undefined
    const column = Math.min(image.width - 1, Math.floor(x * image.width / frame.header.width))
    const row = Math.min(image.height - 1, Math.floor(y * image.height / frame.header.height))
    return image.raw[row * image.width + column]
  }
  const disparity = at('disparity')
  const depth = at('depth')
  const confidence = at('confidence')
  const error = at('depth_error')
  if (disparity !== undefined) values.disparity_px = disparity === frame.header.invalid ? null : disparity / 16
  if (depth !== undefined) values.depth_m = depth === 0 || depth === 65535 ? null : depth / 1000
  if (confidence !== undefined) values.confidence = confidence
  if (error !== undefined) values.depth_error_m = error === 0 || error === 65535 ? null : error / 1000
  return values
}
