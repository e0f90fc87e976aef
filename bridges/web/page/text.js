// SPDX-License-Identifier: Apache-2.0
//
// Numbers as people read them, and the few pieces of markup that several cards share.

export const NONE = '–'

export function fixed(value, digits) {
  return value === null || value === undefined || !Number.isFinite(value) ? NONE : value.toFixed(digits)
}

/** 1234567 -> "1 234 567", with narrow spaces. */
export function counted(value) {
  return value === null || value === undefined ? NONE : String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, '\u202f')
}

export function metres(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE
  return `${value.toFixed(value < 1 ? 3 : value < 10 ? 2 : value < 100 ? 1 : 0)} m`
}

/** A time in microseconds with a unit that leaves two or three digits. */
export function duration(us) {
  if (!Number.isFinite(us)) return NONE
  if (us < 1000) return `${us.toFixed(us < 10 ? 1 : 0)} µs`
  return us < 1e6 ? `${(us / 1e3).toFixed(us < 1e4 ? 2 : us < 1e5 ? 1 : 0)} ms` : `${(us / 1e6).toFixed(1)} s`
}

export function bytes(value) {
  if (!Number.isFinite(value)) return NONE
  return value < 1e6 ? `${(value / 1e3).toFixed(0)} kB` : value < 1e9 ? `${(value / 1e6).toFixed(1)} MB` : `${(value / 1e9).toFixed(2)} GB`
}

export function uptime(seconds) {
  if (!Number.isFinite(seconds)) return NONE
  const s = Math.floor(seconds)
  const two = n => String(n).padStart(2, '0')
  const days = Math.floor(s / 86400)
  return `${days ? `${days} d ` : ''}${two(Math.floor(s / 3600) % 24)}:${two(Math.floor(s / 60) % 60)}:${two(s % 60)}`
}

export function clockTime(date = new Date()) {
  return date.toTimeString().slice(0, 8)
}

export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties)
  element.append(...children)
  return element
}

/** Writes only what has changed, so that a selection or a screen reader is not disturbed. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text
}

/** Shows rows [name, text, tone?, hint?] in a list of facts. Rows are kept where the names stay the same. */
export function showFacts(list, rows) {
  const names = rows.map(row => row[0]).join('\n')
  if (list.dataset.names !== names) {
    list.dataset.names = names
    list.replaceChildren(...rows.map(([name, , , hint]) => {
      const row = make('div', { title: hint ?? '' }, make('dt', { textContent: name }), make('dd'))
      row.dataset.fact = name
      return row
    }))
  }
  rows.forEach(([, text, tone], i) => {
    const value = list.children[i].lastElementChild
    write(value, text)
    value.dataset.tone = tone ?? ''
  })
}
