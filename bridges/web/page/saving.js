// SPDX-License-Identifier: Apache-2.0
//
// Links that save the newest frame: the server answers each with a file.

import { SECOND_IMAGES, imageOf } from './images.js'
import { BASE } from './place.js'
import { make } from './text.js'

const CLOUD = ['depth', '/snapshot.ply', 'Point cloud, PLY', 'cloud.ply']

/** The files of an image. Only pictures and distances are worth a look as JPEG; a PNG has the values. */
function filesOf({ name, title, type, view, unit }) {
  const file = name.replaceAll('_', '-')
  const png = type === 'u8' ? 'PNG' : `16-bit PNG (${name === 'disparity' ? '1/256 px' : unit})`
  const files = [[name, `/snapshot.png?image=${name}`, `${title}, ${png}`, `${file}.png`]]
  if (view === 'picture') files.unshift([name, `/snapshot.jpg?image=${name}`, `${title}, JPEG`, `${file}.jpg`])
  if (view === 'distance') files.unshift([name, `/snapshot.jpg?image=${name}`, `${title} in colours, JPEG`, `${file}.jpg`])
  return files
}

const FILES = [imageOf('left'), ...SECOND_IMAGES].flatMap(filesOf).concat([CLOUD])

/** Fills the list with what the daemon serves. */
export function showSnapshots(root, served) {
  root.replaceChildren(...FILES.filter(([image]) => served(image)).map(([, href, textContent, download]) => make('a', { href: BASE + href, textContent, download })))
}
