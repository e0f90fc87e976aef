// SPDX-License-Identifier: Apache-2.0
//
// The images that a daemon can make: the table of products, as the server's /products.js has it from disparity.proto.

import { PRODUCTS } from './products.js'

const ORDER = ['distance', 'grey', 'spread', 'picture'] // the disparity first, pictures last

/** The images in the order of choices: { name, title, type, view, unit, shown_max, ... } of ProductInfo in disparity.proto. */
export const IMAGES = PRODUCTS.filter(product => product.view !== 'no_view' && product.colour_of === 'product_none')
  .sort((a, b) => ORDER.indexOf(a.view) - ORDER.indexOf(b.view))

/** Those that can stand beside the left image. */
export const SECOND_IMAGES = IMAGES.filter(image => image.name !== 'left')

export const imageOf = name => IMAGES.find(image => image.name === name)

/** What is made of another product, or shown by it in colour. Depth is computed from the disparity by disparity-web. */
export const madeOf = name => name === 'depth' ? 'disparity' : PRODUCTS.find(product => product.colour_of === name)?.name

/** "depth error" for "depth_error". */
export const wordsOf = name => name.replaceAll('_', ' ')
