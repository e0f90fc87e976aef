// SPDX-License-Identifier: Apache-2.0
//
// Keyboard shortcuts: one list serves both the keys and the help that "?" opens.

import { make } from './text.js'

/** Listens to the keys. `shortcuts` is a list of [key, what it does, action]; `more` are lines of help for keys that others handle. */
export function listenToKeys(shortcuts, more, { dialog, list, open, close }) {
  const all = [...shortcuts, ['?', 'this help', () => dialog.showModal()]]
  const named = key => key === ' ' ? 'Space' : key
  list.append(...[...all, ...more].map(([key, what]) => make('div', {}, make('dt', {}, make('kbd', { textContent: named(key) })),
    make('dd', { textContent: what }))))
  open.addEventListener('click', () => dialog.showModal())
  close.addEventListener('click', () => dialog.close())
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented || document.querySelector('dialog[open]')) return
    const { tagName, type } = event.target
    if (tagName === 'SELECT' || tagName === 'INPUT' && type !== 'range' && type !== 'radio') return
    if (event.key === ' ' && ['BUTTON', 'SUMMARY', 'INPUT', 'A'].includes(tagName)) return
    const action = all.find(([key]) => key === event.key)?.[2]
    if (!action) return
    event.preventDefault()
    action()
  })
}
