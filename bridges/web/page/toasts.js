// SPDX-License-Identifier: Apache-2.0
//
// Lines about something that was refused or failed, shown for a while at the edge of the page.

import { make } from './text.js'

const SHOWN_MS = 9000

/** Shows a line. The same line is not shown twice at once. */
export function toast(root, text) {
  if ([...root.children].some(child => child.firstChild.textContent === text)) return
  const close = make('button', { type: 'button', className: 'small square', textContent: '×' })
  close.setAttribute('aria-label', 'Close')
  const line = make('div', { className: 'toast' }, make('span', { textContent: text }), close)
  close.addEventListener('click', () => line.remove())
  setTimeout(() => line.remove(), SHOWN_MS)
  root.append(line)
}
