// SPDX-License-Identifier: Apache-2.0
//
// The dialog that asks for a token.

import { write } from './text.js'

const by = id => document.getElementById(id)

/** `logIn(token)` throws an Error with a line when it is the wrong one; `needed()`: without a token nothing is shown. Returns { ask }. */
export function tokenDialog(logIn, needed) {
  const dialog = by('token-dialog')
  by('token-form').addEventListener('submit', async event => {
    event.preventDefault()
    by('token-send').disabled = true
    try {
      await logIn(by('token').value)
      by('token').value = ''
      dialog.close()
    } catch (error) {
      by('token-error').hidden = false
      write(by('token-error'), error.message)
    } finally {
      by('token-send').disabled = false
    }
  })
  dialog.addEventListener('cancel', event => {
    if (needed()) event.preventDefault()
  })
  const ask = () => {
    if (dialog.open) return
    by('token-error').hidden = true
    dialog.showModal()
  }
  by('token-open').addEventListener('click', ask)
  return { ask }
}
