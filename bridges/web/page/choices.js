// SPDX-License-Identifier: Apache-2.0
//
// Choices as rows of radio buttons and lists, each kept in the settings.

import { choose, settings } from './settings.js'
import { make } from './text.js'

/** A row of radio buttons. `options` is a list of [value, text, hint?]. Returns { show(value), allow(value, allowed, why) }. */
export function radioRow(fieldset, setting, options, onChange) {
  const inputs = new Map()
  for (const [value, text, hint] of options) {
    const input = make('input', { type: 'radio', name: setting, value, checked: settings[setting] === value })
    input.addEventListener('change', () => {
      choose(setting, value)
      onChange()
    })
    inputs.set(value, input)
    fieldset.append(make('label', { title: hint ?? '' }, input, make('span', { textContent: text })))
  }
  const select = value => {
    const input = inputs.get(value)
    if (!input || input.disabled) return
    input.checked = true
    choose(setting, value)
    onChange()
  }
  const allow = (value, allowed, why) => {
    inputs.get(value).disabled = !allowed
    inputs.get(value).parentElement.title = allowed ? '' : why
  }
  return { select, allow }
}

/** A list to choose from. `options` is a list of [value, text]. */
export function list(select, setting, options, onChange) {
  select.append(...options.map(([value, text]) => make('option', { value: String(value), textContent: text })))
  select.value = String(settings[setting])
  if (select.selectedIndex < 0) select.selectedIndex = 0
  select.addEventListener('change', () => {
    choose(setting, options[select.selectedIndex][0])
    onChange()
  })
}
