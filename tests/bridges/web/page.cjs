// SPDX-License-Identifier: Apache-2.0
//
// The live page in a browser, beside a real daemon and a real disparity-web.
//   node page.cjs DISPARITYD DISPARITY_WEB DISPARITYCTL
// Exit status: 0 all is right, 1 something is wrong, 77 the browser or its package is missing (a line says how to install them).
'use strict'

const assert = require('node:assert')
const crypto = require('node:crypto')
const { execFileSync } = require('node:child_process')
const fs = require('node:fs')
const path = require('node:path')
const { PageSession, findBrowser, until } = require('../../../tools/docs/page_session.cjs')
const { readGreyPng } = require('./png.cjs')

const MOVING = 'scene:vga@15'
const STILL = 'scene:vga@15?frames=1' // in a loop: the same frame again and again
const STILL_SETTINGS = ['source.loop=true']
// Pixels of the whole image, among them some that the matcher rejects (left edge) and some near ones.
const PIXELS = [[2, 100], [40, 300], [100, 200], [200, 370], [256, 120], [336, 188], [420, 250], [500, 100], [600, 330], [660, 368]]

/** A page that notes what must not be: errors, and requests that leave this machine. */
async function openPage(session, address, options = {}) {
  const context = await session.browser.newContext(options)
  const page = await context.newPage()
  page.wrong = []
  page.on('console', message => { if (message.type() === 'error') page.wrong.push(`console: ${message.text()}`) })
  page.on('pageerror', error => page.wrong.push(`exception: ${error.message}`))
  page.on('request', request => {
    const { protocol, host } = new URL(request.url())
    if (protocol !== 'blob:' && protocol !== 'data:' && host !== new URL(address).host) page.wrong.push(`request to ${request.url()}`)
  })
  page.on('websocket', socket => { if (new URL(socket.url()).host !== new URL(address).host) page.wrong.push(`WebSocket to ${socket.url()}`) })
  await page.goto(address)
  return page
}

const drawnIndex = (page, id = 'picture-right') =>
  page.evaluate(id => Number(document.querySelector(`#${id} canvas`).dataset.publishIndex ?? 0), id)

/** Waits for a frame after `after`. Returns { index, hash }: its publish_index and its pixels. */
async function nextPicture(page, id, after) {
  return until(`a picture after ${after}`, async () => {
    const { index, pixels } = await page.evaluate(id => {
      const canvas = document.querySelector(`#${id} canvas`)
      return { index: Number(canvas.dataset.publishIndex ?? 0), pixels: canvas.toDataURL() }
    }, id)
    return index > after && { index, hash: crypto.createHash('sha256').update(pixels).digest('hex') }
  })
}

async function checkPictureMoves(page) {
  for (const id of ['picture-left', 'picture-right']) {
    const first = await nextPicture(page, id, 0)
    const second = await nextPicture(page, id, first.index)
    assert.notStrictEqual(first.hash, second.hash, `${id} shows the same pixels for frames ${first.index} and ${second.index}`)
  }
}

async function fact(page, list, name) {
  return page.textContent(`#${list} [data-fact="${name}"] dd`)
}

async function checkNumbers(page, session, address) {
  const count = text => Number(text.replaceAll('\u202f', ''))
  const ask = async () => (await (await fetch(`${address}api/status`)).json()).status
  const before = await ask()
  // The page's status is one between two that are asked for here.
  const shown = await until('a status that is newer than the one asked for', async () => {
    const published = count(await fact(page, 'counts', 'Published'))
    return published > before.published && published
  })
  const after = await until('a status that is newer than the one shown', async () => {
    const status = await ask()
    return status.published >= shown && status
  })
  assert.strictEqual(await page.textContent('#state'), after.state)
  assert.strictEqual(await page.textContent('#source'), after.source)
  assert.strictEqual(await page.isVisible('#synthetic'), after.synthetic)
  assert.strictEqual(await fact(page, 'camera', 'Image'), `${after.geometry.width} x ${after.geometry.height} px`)
  assert.strictEqual(await fact(page, 'camera', 'Calibration'), after.geometry.calibration_id)
  assert.strictEqual(await fact(page, 'camera', 'Baseline'), `${after.geometry.baseline_mm.toFixed(2)} mm`)
  assert.strictEqual(await fact(page, 'camera', 'Matching'), `${after.method} on ${after.backend}, ${after.workers} workers`)
  assert.deepStrictEqual(await page.locator('#notices li').allTextContents(), after.notices)
  const stages = await page.locator('#stages .stage-row:not(.axis) > span:first-child').allTextContents()
  assert.deepStrictEqual(stages, after.steps.map(step => step.name))
  const asked = JSON.parse(execFileSync(session.programs.disparityctl, ['status', '--json', '--socket', `unix:${session.socket}`]))
  assert.deepStrictEqual([asked.source, asked.geometry], [after.source, after.geometry], 'disparityctl and disparity-web differ')
}

/** Turns the text of a readout into a number, null for "unknown". */
function valueOf(text) {
  if (text === 'unknown') return null
  return Number(/-?[\d.]+/.exec(text)[0])
}

/** Points at a pixel with the mouse and waits for the values of a frame that was drawn afterwards. */
async function pointAt(page, [x, y], size) {
  const box = await page.locator('#picture-right').boundingBox()
  await page.mouse.move(box.x + (x + 0.5) / size.width * box.width, box.y + (y + 0.5) / size.height * box.height)
  await until(`pixel ${x}, ${y} is pointed at`, async () => await page.textContent('#at-pixel') === `${x}, ${y}`)
  const index = await drawnIndex(page)
  return until(`values of pixel ${x}, ${y}`, () => page.evaluate(index => {
    if (Number(document.getElementById('readout').dataset.publishIndex) <= index) return null
    const text = id => document.getElementById(id).textContent
    const values = { disparity: text('at-disparity'), depth: text('at-depth'), sigma: text('at-sigma'), confidence: text('at-confidence') }
    return Object.values(values).includes('–') ? null : values
  }, index))
}

async function checkPointer(page, address) {
  const read = async image => readGreyPng(Buffer.from(await (await fetch(`${address}snapshot.png?image=${image}`)).arrayBuffer()))
  const truth = { disparity: await read('disparity'), depth: await read('depth'), error: await read('depth_error'), confidence: await read('confidence') }
  assert.deepStrictEqual([truth.disparity.bits, truth.depth.bits, truth.confidence.bits], [16, 16, 8])
  let known = 0
  for (const [x, y] of PIXELS) {
    const values = await pointAt(page, [x, y], truth.depth)
    const at = image => truth[image].values[y * truth[image].width + x]
    const depth = at('depth')
    const where = `pixel ${x}, ${y}: ${JSON.stringify(values)}`
    assert.strictEqual(valueOf(values.confidence), at('confidence'), where)
    if (depth === 0) {
      assert.deepStrictEqual([values.disparity, values.depth], ['unknown', 'unknown'], where)
      continue
    }
    ++known
    assert.ok(Math.abs(valueOf(values.disparity) - at('disparity') / 256) <= 0.0051, `${where}, the frame has ${at('disparity') / 256} px`)
    assert.ok(Math.abs(valueOf(values.depth) / (depth / 1000) - 1) < 0.006, `${where}, the frame has ${depth} mm`)
    assert.ok(Math.abs(valueOf(values.sigma) - at('error') / 1000) < 0.006, `${where}, the frame has ${at('error')} mm`)
  }
  assert.ok(known >= PIXELS.length / 2, `only ${known} pixels have a depth`)
}

const choose = (page, name, value) => page.check(`input[name="${name}"][value="${value}"]`)

async function checkImages(page) {
  for (const image of ['depth_error', 'confidence', 'disparity', 'depth']) {
    await choose(page, 'image', image)
    const caption = image.replace('_', ' ')
    await until(`the picture of ${caption}`, async () => (await page.textContent('#picture-right figcaption')).split(',')[0] === caption)
  }
}

/** The colours of a grid of pixels of the right picture, once a frame after `index` shows the image in this encoding. */
async function coloursOf(page, image, encoding) {
  await choose(page, 'image', image)
  await choose(page, 'encoding', encoding)
  const before = await drawnIndex(page)
  // A few frames of the encoding before may be on their way.
  return until(`${image} as ${encoding}`, () => page.evaluate(({ before, image }) => {
    const canvas = document.querySelector('#picture-right canvas')
    const caption = document.querySelector('#picture-right figcaption').textContent
    if (Number(canvas.dataset.publishIndex) < before + 6 || caption !== image.replace('_', ' ') || canvas.width !== 672) return null
    const context = canvas.getContext('2d')
    const colours = []
    for (let y = 4; y < canvas.height; y += 8) for (let x = 4; x < canvas.width; x += 8) colours.push([...context.getImageData(x, y, 1, 1).data])
    return colours
  }, { before, image }))
}

/** The page colours raw values as the server does. JPEG blurs edges, so some pixels may differ. */
async function checkColours(page) {
  await page.selectOption('#width-choice', '0')
  for (const image of ['disparity', 'depth', 'depth_error', 'confidence']) {
    const jpeg = await coloursOf(page, image, 'jpeg')
    const own = await coloursOf(page, image, 'lossless')
    const same = jpeg.filter((colour, i) => colour.every((value, c) => Math.abs(value - own[i][c]) <= 25)).length
    assert.ok(same > 0.9 * jpeg.length, `${image}: only ${same} of ${jpeg.length} pixels have the colour that the server gives them`)
    assert.ok(new Set(own.map(String)).size > 10, `${image}: hardly any colours`)
  }
}

async function checkRange(page) {
  const before = await page.textContent('#range-text')
  await page.focus('#range-far')
  for (let i = 0; i < 3; ++i) await page.keyboard.press('PageDown')
  const after = await until('a narrower range', async () => {
    const text = await page.textContent('#range-text')
    return text !== before && text
  })
  const far = text => valueOf(text.split(' – ')[1])
  assert.ok(far(after) < far(before), `${before} -> ${after}`)
  await page.click('#range-auto')
  await until('the automatic range', async () => await page.textContent('#range-text') === before)
}

/** Walks with the Tab key until it comes around, and asks that every control was on the way. */
async function checkKeyboard(page) {
  const marked = await page.evaluate(() => {
    const seen = element => element.checkVisibility() && !element.disabled && !element.closest('[inert]')
    // Of radio buttons, the Tab key reaches the chosen one; the arrow keys the others.
    const all = [...document.querySelectorAll('button, summary, select, input:not([type=radio]), input[type=radio]:checked, [tabindex="0"]')].filter(seen)
    all.forEach((element, i) => { element.dataset.reach = i })
    document.activeElement.blur()
    return all.map(element => element.id || element.textContent.trim() || element.name)
  })
  const reached = new Set()
  for (let i = 0; i < 3 * marked.length + 20 && reached.size < marked.length; ++i) {
    await page.keyboard.press('Tab')
    const mark = await page.evaluate(() => document.activeElement?.dataset.reach ?? null)
    if (mark !== null) reached.add(Number(mark))
  }
  assert.deepStrictEqual(marked.filter((_, i) => !reached.has(i)), [], 'not reached by the Tab key')
  await page.focus('#pause')
  await page.keyboard.press('?')
  assert.ok(await page.isVisible('#help'), '? opens the help')
  await page.keyboard.press('Escape')
  assert.ok(!await page.isVisible('#help'), 'Escape closes it')
}

async function checkRecording(page, session) {
  await page.click('#record')
  const usual = await page.inputValue('#record-path')
  assert.match(usual, /^\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d\.mkv$/)
  await page.keyboard.press('Enter')
  await until('a recording', async () => await page.getAttribute('#record', 'aria-pressed') === 'true')
  await until('frames in it', async () => !/\b0 frames/.test(await fact(page, 'recording', 'Length')))
  await page.click('#record')
  await until('its end', async () => await page.getAttribute('#record', 'aria-pressed') === 'false')
  assert.ok(fs.statSync(path.join(session.folder, usual)).size > 0)
}

async function checkPhone(session, address) {
  const page = await openPage(session, address, { viewport: { width: 360, height: 740 }, hasTouch: true })
  await nextPicture(page, 'picture-right', 0)
  const wide = await page.evaluate(() => document.documentElement.scrollWidth)
  assert.ok(wide <= 360, `the page is ${wide} px wide on a screen of 360 px`)
  const box = await page.locator('#picture-left').boundingBox()
  await page.touchscreen.tap(box.x + box.width / 2, box.y + box.height / 2)
  await until('the value of a tapped pixel', async () => !['–', 'point at one'].includes(await page.textContent('#at-disparity')))
  await page.locator('#cloud').scrollIntoViewIfNeeded()
  await until('the point cloud', () => page.evaluate(() => Number(document.querySelector('#cloud canvas').dataset.points) > 0))
  assert.deepStrictEqual(page.wrong, [])
  await page.context().close()
}

/** Enters a token and waits for what happens. The server lets a second try wait after a wrong one. */
async function enterToken(page, token, what, happened) {
  await until(what, async () => {
    if (await happened()) return true
    await page.evaluate(token => {
      const form = document.getElementById('token-form')
      if (!form.closest('dialog').open) return
      form.querySelector('#token').value = token
      form.querySelector('[type=submit]').click() // does nothing while the token before is being looked at
    }, token)
    return happened()
  })
}

/** Writes a file of tokens and returns the options that name it. */
function tokenFile(session) {
  const file = path.join(session.folder, 'tokens')
  fs.writeFileSync(file, 'view 0123456789abcdef-view\ncontrol 0123456789abcdef-control\n', { mode: 0o600 })
  return ['--token-file', file]
}

async function checkTokens(session) {
  const { address } = await session.startWeb('127.0.0.1:0', tokenFile(session))
  const page = await openPage(session, address, { viewport: { width: 1440, height: 900 } })
  await until('the page asks for a token', () => page.isVisible('#token-dialog'))
  assert.strictEqual(await drawnIndex(page), 0)
  await enterToken(page, 'wrong', 'the line about a wrong token', () => page.isVisible('#token-error'))
  assert.notStrictEqual((await page.textContent('#token-error')).trim(), '')
  await enterToken(page, '0123456789abcdef-view', 'pictures', async () => await drawnIndex(page) > 0)
  await until('a status', async () => await page.textContent('#state') === 'running')
  assert.ok(await page.isDisabled('#record'))
  assert.match(await page.getAttribute('#record', 'title'), /control token/)
  await page.click('#token-open')
  await enterToken(page, '0123456789abcdef-control', 'the right to record', () => page.isEnabled('#record'))
  assert.deepStrictEqual(page.wrong.filter(line => !/status of (403|429)/.test(line)), [])
  await page.context().close()
}

/** A picture that no other one follows does not look like a new one. */
async function checkOldTile(page, session) {
  const name = `${session.name}-ends`
  const daemon = session.startDaemon('scene:vga@15?frames=30', [], name)
  const picture = page.locator(`#daemons li[data-name="${name}"] .picture`)
  const says = text => until(`the tile says "${text}"`, async () =>
    await picture.count() > 0 && await picture.locator('.no-picture').textContent() === text && picture.evaluate(it => it.classList.contains('stale')))
  await says('The source has ended')
  await session.crash(daemon)
  await says('no picture')
}

/** The page of all daemons: this test's has a tile with a live picture, which leads to its page. Others of the machine may be there. */
async function checkAllDaemons(session) {
  const { process: web, address } = await session.startWebOfAll(tokenFile(session))
  const page = await openPage(session, address, { viewport: { width: 360, height: 740 } })
  const tile = page.locator(`#daemons li[data-name="${session.name}"]`)
  await enterToken(page, '0123456789abcdef-control', 'a tile', () => tile.isVisible())
  const drawn = () => tile.locator('canvas').evaluate(canvas => Number(canvas.dataset.publishIndex ?? 0))
  const first = await until('a picture in the tile', drawn)
  await until('the next one', async () => await drawn() > first)
  await until('the state in the tile', async () => await tile.locator('.pill').textContent() === 'running')
  const wide = await page.evaluate(() => document.documentElement.scrollWidth)
  assert.ok(wide <= 360, `the page is ${wide} px wide on a screen of 360 px`)
  await checkOldTile(page, session)
  await tile.locator('a').click()
  await nextPicture(page, 'picture-right', 0)
  assert.strictEqual(page.url(), `${address}i/${session.name}/`)
  assert.strictEqual(await page.textContent('#daemon-name'), session.name)
  await until('the right to record', () => page.isEnabled('#record'))
  const link = await page.locator('#snapshot-links a').first().getAttribute('href')
  assert.strictEqual(await page.evaluate(async link => (await fetch(link)).status, link), 200)
  await page.goto(`${address}i/nobody-${session.name}/`)
  await bannerSays(page, 'The daemon is gone')
  await page.click('#place a')
  await until('the tile again', () => tile.isVisible())
  assert.deepStrictEqual(page.wrong.filter(line => !/status of (401|404)/.test(line)), [])
  await page.context().close()
  await session.crash(web)
}

async function checkHidden(page) {
  // A page in the background draws nothing and asks for nothing.
  await page.evaluate(() => {
    Object.defineProperty(document, 'hidden', { configurable: true, get: () => true })
    document.dispatchEvent(new Event('visibilitychange'))
  })
  await until('no frame while hidden', async () => await fact(page, 'link', 'Drawn') === '0.0 /s')
  const index = await drawnIndex(page)
  await page.evaluate(() => {
    delete document.hidden
    document.dispatchEvent(new Event('visibilitychange'))
  })
  await nextPicture(page, 'picture-right', index)
}

const bannerSays = (page, title) => until(`the banner says "${title}"`, async () =>
  await page.isVisible('#banner') && await page.textContent('#banner-title') === title)
const bannerGoes = page => until('the banner goes', async () => !await page.isVisible('#banner'))

async function checkDaemonRestart(page, session, daemon) {
  await session.crash(daemon)
  await bannerSays(page, 'The daemon is gone')
  assert.notStrictEqual((await page.textContent('#banner-text')).trim(), '')
  assert.ok(await page.isDisabled('#record'), 'nothing can be recorded without a daemon')
  session.startDaemon(STILL, STILL_SETTINGS)
  await bannerGoes(page)
  await until('pictures of the new daemon', async () => !await page.evaluate(() =>
    document.getElementById('picture-right').classList.contains('stale')) && await page.textContent('#source') === STILL)
  assert.match(await page.textContent('#log'), /the daemon is back/)
}

async function checkWebRestart(page, session, web) {
  await session.crash(web.process)
  await bannerSays(page, 'disparity-web is gone')
  const index = await drawnIndex(page)
  const again = await session.startWeb(new URL(web.address).host)
  await bannerGoes(page)
  await nextPicture(page, 'picture-right', index)
  // The browser itself notes each request that found nobody; nothing else may be there.
  const others = page.wrong.filter(line => !/ERR_CONNECTION_REFUSED|WebSocket connection .* failed/.test(line))
  assert.deepStrictEqual(others, [])
  return again
}

async function checkAll(session) {
  const daemon = session.startDaemon(MOVING)
  const web = await session.startWeb()
  const page = await openPage(session, web.address, { viewport: { width: 1440, height: 900 } })
  const step = async (name, check) => {
    await check()
    console.log(`ok: ${name}`)
  }
  await step('the pictures move', () => checkPictureMoves(page))
  await step('numbers are those of the status', () => checkNumbers(page, session, web.address))
  await step('each image is shown', () => checkImages(page))
  await step('the range of colours', () => checkRange(page))
  await step('the keyboard reaches everything', () => checkKeyboard(page))
  await step('recording', () => checkRecording(page, session))
  await step('hidden', () => checkHidden(page))
  await step('the daemon is killed and comes back', () => checkDaemonRestart(page, session, daemon))
  await step('values at the pointer, JPEG', () => checkPointer(page, web.address))
  // As many frames as this browser draws by the processor alone; of more, the server makes smaller ones.
  await page.selectOption('#rate-choice', '2')
  // The page takes from raw values what the shown image has, and the rest from the server's answer.
  await choose(page, 'encoding', 'lossless')
  for (const image of ['disparity', 'depth', 'confidence', 'depth_error']) {
    await choose(page, 'image', image)
    await until(`raw values of ${image}`, async () => (await page.textContent('#picture-right figcaption')) === image.replace('_', ' '))
    await step(`values at the pointer, lossless, ${image}`, () => checkPointer(page, web.address))
  }
  await step('colours are those of the server', () => checkColours(page))
  await page.selectOption('#rate-choice', '0')
  await step('tokens', () => checkTokens(session))
  await step('all daemons', () => checkAllDaemons(session))
  await step('a phone', () => checkPhone(session, web.address))
  assert.deepStrictEqual(page.wrong, [])
  await step('disparity-web is killed and comes back', () => checkWebRestart(page, session, web))
}

async function main() {
  const browser = findBrowser()
  if (typeof browser === 'string') {
    console.log(`skipped: ${browser}`)
    process.exit(77)
  }
  const [disparityd, disparity_web, disparityctl] = process.argv.slice(2).map(file => path.resolve(file))
  const session = new PageSession({ disparityd, disparity_web, disparityctl })
  try {
    await session.startBrowser(browser)
    await checkAll(session)
  } catch (error) {
    console.error(`${error.stack}\n\nThe programs said:\n${session.log}`)
    process.exitCode = 1
  } finally {
    await session.end()
  }
}

main()
