// SPDX-License-Identifier: Apache-2.0
//
// Links that save the newest frame: the server answers each with a file.

import { make } from './text.js'

const FILES = [
  ['left', '/snapshot.jpg?image=left', 'Left image, JPEG', 'left.jpg'],
  ['left', '/snapshot.png?image=left', 'Left image, PNG', 'left.png'],
  ['disparity', '/snapshot.jpg?image=disparity', 'Disparity in colours, JPEG', 'disparity.jpg'],
  ['disparity', '/snapshot.png?image=disparity', 'Disparity, 16-bit PNG (1/256 px)', 'disparity.png'],
  ['depth', '/snapshot.jpg?image=depth', 'Depth in colours, JPEG', 'depth.jpg'],
  ['depth', '/snapshot.png?image=depth', 'Depth, 16-bit PNG (mm)', 'depth.png'],
  ['depth_error', '/snapshot.png?image=depth_error', 'Depth error, 16-bit PNG (mm)', 'depth-error.png'],
  ['confidence', '/snapshot.png?image=confidence', 'Confidence, PNG', 'confidence.png'],
  ['depth', '/snapshot.ply', 'Point cloud, PLY', 'cloud.ply'],
]

/** Fills the list with what the daemon serves. */
export function showSnapshots(root, served) {
  root.replaceChildren(...FILES.filter(([image]) => served(image)).map(([, href, textContent, download]) => make('a', { href, textContent, download })))
}
