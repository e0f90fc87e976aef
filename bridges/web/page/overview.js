// SPDX-License-Identifier: Apache-2.0
//
// The page of disparity-web --all: each daemon of the machine as a tile with its state and a small live picture, which leads to its page.

import { ask, post } from './connection.js'
import { showState } from './status.js'
import { write } from './text.js'
import { Tile } from './tile.js'
import { tokenDialog } from './token.js'

const INTERVAL_MS = 1000

const by = id => document.getElementById(id)

const tiles = new Map() // name -> Tile
let tokenNeeded = false
let timer = 0

const watcher = new IntersectionObserver(entries => {
  for (const { target, isIntersecting } of entries) {
    [...tiles.values()].find(tile => tile.item === target)?.look({ onScreen: isIntersecting })
  }
}, { rootMargin: '100px' })

const tokens = tokenDialog(async token => {
  await post('/api/session', { token })
  await follow()
  for (const tile of tiles.values()) tile.again()
}, () => tokenNeeded)

/** Shows the daemons in the server's order, and keeps the tiles of those that were there before. */
function showTiles(entries) {
  for (const [name, tile] of tiles) {
    if (entries.some(entry => entry.name === name)) continue
    watcher.unobserve(tile.item)
    tile.close()
    tiles.delete(name)
  }
  entries.forEach((entry, i) => {
    let tile = tiles.get(entry.name)
    if (!tile) {
      tile = new Tile(entry)
      tiles.set(entry.name, tile)
      by('daemons').insertBefore(tile.item, by('daemons').children[i] ?? null)
      watcher.observe(tile.item)
    }
    tile.show(entry)
  })
}

function show({ instances, note }) {
  showTiles(instances)
  by('note').hidden = note === ''
  write(by('note'), note)
  const well = [...tiles.values()].filter(tile => tile.well).length
  showState(instances.length ? `${well} of ${instances.length} running` : 'no daemon',
    well === instances.length && well > 0 ? 'good' : instances.length ? 'warn' : 'quiet', null, by('summary'))
}

/** Asks for the list once, and says what keeps it away. */
async function follow() {
  try {
    show(await ask('/api/instances'))
    tokenNeeded = false
  } catch (error) {
    tokenNeeded = error.status === 401
    if (tokenNeeded) tokens.ask()
    showState(tokenNeeded ? 'token needed' : 'no connection', 'quiet',
      tokenNeeded ? null : { tone: 'bad', title: 'disparity-web is gone', text: `${error.message}. Trying again.` }, by('summary'))
  }
  document.body.classList.toggle('away', by('summary').textContent === 'no connection')
  by('token-open').hidden = !tokenNeeded
}

async function tick() {
  clearTimeout(timer)
  if (!document.hidden) await follow()
  clearTimeout(timer)
  timer = setTimeout(tick, INTERVAL_MS)
}

document.addEventListener('visibilitychange', () => {
  for (const tile of tiles.values()) tile.look({})
  if (!document.hidden) tick()
})

write(by('machine'), location.host)
tick()
