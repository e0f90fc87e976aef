// SPDX-License-Identifier: Apache-2.0
//
// Puts the page together: who hears of what, what is subscribed to, and what the page says when something is away.

import { Trend, StageChart } from './charts.js'
import { list, radioRow } from './choices.js'
import { Cloud } from './cloud.js'
import { measurable } from './colours.js'
import { Connection } from './connection.js'
import { Controls } from './controls.js'
import { listenToKeys } from './keys.js'
import { Legend } from './legend.js'
import { SECOND_IMAGES as SECOND, madeOf, wordsOf } from './images.js'
import { Live } from './live.js'
import { Log } from './log.js'
import { NO_FRAME_MS } from './pane.js'
import { Picture, Pointer } from './pictures.js'
import { NAME } from './place.js'
import { Radar } from './radar.js'
import { Recording } from './recording.js'
import { Sensors } from './sensors.js'
import { choose, settings } from './settings.js'
import { showSnapshots } from './saving.js'
import { problemOf, showState, showStatus } from './status.js'
import { NONE, bytes, counted, duration, fixed, showFacts, write } from './text.js'
import { toast } from './toasts.js'
import { tokenDialog } from './token.js'

const CLOUD_STEP = 4
// The widths that disparity-web makes of pictures, besides the whole one.
const SHARED_WIDTHS = [16, 40, 80, 160, 320, 480, 640, 960, 1280, 1920, 2560, 3840]
const TICK_MS = 500
const POINT_MS = 40 // at most this often a new pixel is asked for
const NO_SCAN = 'This daemon makes no obstacle scans: set [scan] enabled = true.'
const SECOND_IMAGES = SECOND.map(image => image.name)

const by = id => document.getElementById(id)
const refused = text => toast(by('toasts'), text)

let link = { link: 'connecting', why: '' }
let message = null // the newest status message of the server
let products = null // what the daemon serves; null = not known yet
let paused = false
let askedAt = performance.now() // since when frames are asked for

const log = new Log(by('log'))
const left = new Picture(by('picture-left'))
const right = new Picture(by('picture-right'))
const pointer = new Pointer([left, right], pointed)
const legend = new Legend(by('legend'), chooseRange)
const cloud = new Cloud(by('cloud'))
const radar = new Radar(by('radar'), by('radar-nearest'))
const stages = new StageChart(by('stages'))
const sensors = new Sensors(by('sensors'))
const controls = new Controls(by('controls'), refused)
const recording = new Recording(refused)
const connection = new Connection({
  state: linkChanged,
  hello: hello => {
    products = hello.products.length ? hello.products : null // none while there is no daemon
    by('version').title = hello.version
    showProducts()
  },
  status: statusCame,
  sensors: sample => sensors.take(sample),
  frame: (buffer, arrived) => live.take(buffer, arrived),
  error: text => {
    refused(text)
    log.add(text, 'warn')
  },
})
const live = new Live({ connection, left, right, pointer, legend, cloud, radar, toldProblem: refused })
const trends = {
  rate: new Trend(by('rate-chart'), 10),
  age: new Trend(by('age-chart'), 20),
  bandwidth: new Trend(by('bandwidth-chart'), 1),
}

// --- what is subscribed to ---

const shown = new Map() // element -> whether any of it is on the screen
const watcher = new IntersectionObserver(entries => {
  for (const entry of entries) shown.set(entry.target, entry.isIntersecting)
  subscribe()
}, { rootMargin: '100px' })

const served = name => products === null || products.includes(name) || products.includes(madeOf(name))

function images() {
  const wanted = []
  if (settings.view !== 'right' || cloudWanted() && settings.cloudColour === 'left') wanted.push('left')
  if (settings.view !== 'left') wanted.push(served(settings.image) ? settings.image : SECOND_IMAGES.find(served))
  return wanted.filter(name => name && served(name))
}

const cloudWanted = () => cloud.usable && by('cloud-card').open && shown.get(by('cloud'))
const radarWanted = () => by('radar-card').open && shown.get(by('radar')) && served('scan')

/** The width in which pictures are asked for: 0 = all of it. Raw values are only right in full. */
function width() {
  if (settings.width !== 'fit') return settings.width
  if (settings.encoding === 'lossless') return 0
  const widest = Math.max(left.figure.clientWidth, right.figure.clientWidth) * devicePixelRatio
  const whole = live.frame?.header.width ?? Infinity
  const width = SHARED_WIDTHS.find(shared => shared >= widest) ?? 0
  return width >= whole ? 0 : width
}

function subscribe() {
  const nothing = document.hidden || paused
  connection.subscribe({
    images: nothing ? [] : images(),
    encoding: settings.encoding,
    max_width: width(),
    max_rate: settings.rate,
    range_m: settings.range,
    cloud_step: !nothing && cloudWanted() ? CLOUD_STEP : 0,
    scan: Boolean(!nothing && radarWanted()),
    sensors: !document.hidden,
  })
  by('pair').dataset.view = settings.view
}

function showProducts() {
  for (const name of SECOND_IMAGES) imageChoice.allow(name, served(name), `This daemon makes no ${wordsOf(name)}.`)
  if (!served('scan')) radar.show(null, NO_SCAN)
  showSnapshots(by('snapshot-links'), served)
  subscribe()
}

// --- what the user does ---

const imageChoice = radioRow(by('image-choice'), 'image',
  SECOND.map((image, i) => [image.name, image.title, String(i + 1)]), changed)
const viewChoice = radioRow(by('view-choice'), 'view', [['both', 'Both'], ['left', 'Left'], ['right', 'Right']], changed)
const encodingChoice = radioRow(by('encoding-choice'), 'encoding', [['jpeg', 'JPEG', 'Small'], ['lossless', 'Lossless', 'Raw values']], changed)
const cloudChoice = radioRow(by('cloud-colour'), 'cloudColour', [['left', 'Image'], ['depth', 'Depth']], changed)
list(by('width-choice'), 'width', [['fit', 'as shown'], [0, 'full'], [640, '640 px'], [480, '480 px'], [320, '320 px']], changed)
list(by('rate-choice'), 'rate', [[0, 'all'], [15, '15 /s'], [10, '10 /s'], [5, '5 /s'], [2, '2 /s'], [1, '1 /s']], changed)

function changed() {
  colourCloud()
  subscribe()
}

function chooseRange(range) {
  choose('range', range)
  changed()
}

/** The points are coloured as the pictures are. */
function colourCloud() {
  if (!cloud.usable) return
  const range = live.colours ?? settings.range ?? (live.frame && measurable(live.frame.header))
  cloud.colour(settings.cloudColour === 'depth', range, settings.image === 'depth' ? 'depth' : 'disparity')
}

let pointTimer = 0
function pointed(place) {
  live.showPoint(place)
  pointTimer ||= setTimeout(() => {
    pointTimer = 0
    connection.point(pointer.place)
  }, POINT_MS)
}

function pause() {
  paused = !paused
  by('pause').setAttribute('aria-pressed', String(paused))
  write(by('pause'), paused ? 'Go on' : 'Pause')
  document.body.classList.toggle('held', paused)
  askedAt = performance.now()
  subscribe()
}

function fill() {
  if (document.fullscreenElement) document.exitFullscreen()
  else by('pictures').requestFullscreen?.().catch(error => refused(`full screen: ${error.message}`))
}

function nextOf(choice, setting, values) {
  choice.select(values[(values.indexOf(settings[setting]) + 1) % values.length])
}

by('pause').addEventListener('click', pause)
by('full').addEventListener('click', fill)
by('full').hidden = !document.fullscreenEnabled
by('cloud-home').addEventListener('click', () => cloud.home())
document.addEventListener('visibilitychange', () => {
  askedAt = performance.now()
  subscribe()
})
for (const id of ['cloud', 'radar']) {
  watcher.observe(by(id))
  by(`${id}-card`).addEventListener('toggle', subscribe)
}
let sizeTimer = 0
new ResizeObserver(() => {
  clearTimeout(sizeTimer)
  sizeTimer = setTimeout(subscribe, 300)
}).observe(by('pair'))
const tokens = tokenDialog(token => connection.logIn(token), () => link.link === 'token')
document.addEventListener('click', event => {
  if (!by('snapshots').contains(event.target)) by('snapshots').open = false
})

listenToKeys([
  [' ', 'hold the picture, go on', pause],
  ...SECOND_IMAGES.map((name, i) => [String(i + 1), `show ${wordsOf(name)}`, () => imageChoice.select(name)]),
  ['v', 'both pictures, left, right', () => nextOf(viewChoice, 'view', ['both', 'left', 'right'])],
  ['f', 'full screen', fill],
  ['a', 'automatic range of colours', () => chooseRange(null)],
  ['e', 'JPEG or lossless', () => nextOf(encodingChoice, 'encoding', ['jpeg', 'lossless'])],
  ['c', 'colours of the point cloud', () => nextOf(cloudChoice, 'cloudColour', ['left', 'depth'])],
  ['r', 'start or stop recording', () => recording.toggle()],
  ['s', 'list of snapshots', () => { by('snapshots').open = !by('snapshots').open }],
  ['Escape', 'let go of the pixel', () => {
    by('snapshots').open = false
    pointer.release()
  }],
], [['← ↑ → ↓', 'in a picture: move the pixel (Shift: 10 px); in the point cloud: turn it (Shift: shift it)'],
  ['+ −', 'in the point cloud: nearer, farther'], ['0', 'in the point cloud: the first view']],
{ dialog: by('help'), list: by('keys'), open: by('help-open'), close: by('help-close') })

// --- what is said when something is away ---

/** Returns what the banner says, or null while all is well. */
function problem() {
  if (link.link === 'lost') return { tone: 'bad', title: 'disparity-web is gone', text: `${link.why}. Trying again.` }
  if (link.link === 'absent') return { tone: 'bad', title: 'The daemon is gone', text: link.why }
  if (link.link !== 'open') return null
  if (message?.daemon === 'gone') return { tone: 'bad', title: 'The daemon is gone', text: message.why }
  return message?.status ? problemOf(message.status) : null
}

function whyNoPicture(wrong) {
  if (paused) return ''
  const silent = performance.now() - Math.max(live.drawnAt, askedAt)
  // A warning about frames that do come stands in the banner.
  if (wrong && (wrong.tone === 'bad' || silent > NO_FRAME_MS)) return wrong.title
  if (link.link !== 'open') return 'connecting'
  return silent > NO_FRAME_MS && images().length ? `no frame for ${fixed(silent / 1000, 0)} s` : live.frame ? '' : 'no frame yet'
}

function showProblem() {
  const wrong = problem()
  const state = link.link === 'open' ? message?.daemon === 'gone' ? 'daemon gone' : message?.status?.state ?? 'connecting'
    : { lost: 'no connection', absent: 'daemon gone', token: 'token needed' }[link.link] ?? 'connecting'
  showState(state, wrong?.tone ?? (['running', 'idle'].includes(state) ? 'good' : 'quiet'), wrong)
  const why = whyNoPicture(wrong)
  left.say(why)
  right.say(why)
  if (cloud.usable && why) cloud.say(why)
  radar.say(!served('scan') ? NO_SCAN : why)
  by('snapshot-links').inert = link.link !== 'open' || message?.daemon === 'gone'
  document.body.classList.toggle('away', link.link !== 'open' || message?.daemon === 'gone')
}

function linkChanged(next) {
  if (next.link !== link.link) {
    if (next.link === 'open') log.add(link.link === 'lost' ? 'disparity-web is back' : 'connected', 'good')
    if (['lost', 'absent'].includes(next.link)) log.add(next.why, 'bad')
  }
  link = next
  if (link.link === 'open') {
    askedAt = performance.now()
    live.reset()
    if (pointer.place) connection.point(pointer.place)
  } else {
    follow(null)
  }
  if (link.link === 'token') tokens.ask()
  showProblem()
}

function statusCame(next) {
  message = next
  log.take(next)
  showStatus(next.status, next.facts)
  if (next.status) {
    stages.show(next.status.steps)
    sensors.check(next.status.sensors)
    colourCloud()
  }
  trends.rate.add(next.status ? next.status.rate : null)
  follow(next.status)
  showProblem()
}

/** Follows a status with all that needs a daemon and the right to control it. */
function follow(status) {
  const { needs_token: needsToken, control } = connection.session
  by('token-open').hidden = !needsToken || control
  recording.follow(status, control)
  controls.follow(status, control)
}

let receivedBefore = 0
let tickedAt = performance.now()
function tick() {
  const now = performance.now()
  const megabits = (connection.received - receivedBefore) * 8 / 1e3 / (now - tickedAt)
  receivedBefore = connection.received
  tickedAt = now
  const age = live.takeAge()
  trends.age.add(age)
  trends.bandwidth.add(link.link === 'open' ? megabits : null)
  write(by('age'), age === null ? NONE : duration(age * 1000))
  write(by('bandwidth'), link.link === 'open' ? `${fixed(megabits, megabits < 10 ? 2 : 1)} Mbit/s` : NONE)
  if (message?.daemon === 'gone' || link.link !== 'open') write(by('rate'), NONE)
  showLink(message?.link)
  showProblem()
}

function showLink(sent) {
  const scale = sent?.scale ?? 1
  const shownFrame = live.frame?.images[settings.image] ?? live.frame?.images.left
  showFacts(by('link'), [
    ['Drawn', `${fixed(live.rate, 1)} /s`],
    ['Sent', sent ? bytes(sent.sent_bytes) : NONE],
    ['Frames', counted(sent?.frames)],
    ['Skipped', counted(sent?.skipped), '', 'Not sent to this page: it or the network was slower than the daemon, or a lower rate was asked for'],
    ['Scale', scale === 1 ? 'full' : `1 / ${scale}`, scale === 1 ? '' : 'warn', 'The server halves the pictures where the network is slow'],
    ['Picture', shownFrame ? `${shownFrame.width} x ${shownFrame.height}` : NONE],
  ])
}

by('place').hidden = !NAME
write(by('daemon-name'), NAME)
showProducts()
showProblem()
setInterval(tick, TICK_MS)
connection.connect()
