// SPDX-License-Identifier: Apache-2.0
//
// What the user has chosen, kept by the browser from one visit to the next. Without storage the choices last as long as the page.

const KEY = 'disparityd'
const usual = {
  image: 'disparity', // the second picture
  view: 'both', // or 'left', 'right'
  encoding: 'jpeg', // or 'lossless'
  width: 'fit', // or a number of px, 0 = full
  rate: 0, // frames per second, 0 = all
  range: null, // [near, far] in m, null = auto
  cloudColour: 'left', // or 'depth'
}

function stored() {
  try {
    return JSON.parse(localStorage.getItem(KEY)) ?? {}
  } catch {
    return {}
  }
}

/** The choices as they are now. Change them with choose(), so that they are kept. */
export const settings = { ...usual, ...stored() }

export function choose(name, value) {
  settings[name] = value
  try {
    localStorage.setItem(KEY, JSON.stringify(settings))
  } catch {
    // A browser may forbid storage: the choice then holds until the page is closed.
  }
}
