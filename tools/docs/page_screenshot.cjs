// SPDX-License-Identifier: Apache-2.0
//
// Makes the pictures of the live page in the documentation, from a real daemon on a rendered scene and a real disparity-web.
//   node tools/docs/page_screenshot.cjs [BIN [FOLDER]]
// BIN holds the programs (build/release/bin); page.png and page-phone.png go to FOLDER (docs/pictures). It needs Chromium and the npm
// package playwright-core: npm install --prefix SOMEWHERE playwright-core, then DISPARITYD_NODE_MODULES=SOMEWHERE/node_modules.
'use strict'

const path = require('node:path')
const { PageSession, findBrowser, until } = require('./page_session.cjs')

const FRAMES_BEFORE = 60 // so that the charts have something to show
const VIEWS = [
  { file: 'page.png', viewport: { width: 1440, height: 940 } },
  { file: 'page-phone.png', viewport: { width: 360, height: 740 }, hasTouch: true, deviceScaleFactor: 2 },
]

async function takePicture(browser, address, { file, ...options }, folder) {
  const page = await browser.newPage({ colorScheme: 'dark', ...options })
  await page.goto(address)
  const drawn = () => page.evaluate(() => Number(document.querySelector('#picture-right canvas').dataset.publishIndex ?? 0))
  const first = await until('a picture', drawn)
  const box = await page.locator('#picture-right').boundingBox()
  const place = [box.x + box.width * 0.62, box.y + box.height * 0.62]
  await (options.hasTouch ? page.touchscreen.tap(...place) : page.mouse.click(...place))
  await until('enough frames', async () => await drawn() >= first + FRAMES_BEFORE)
  await page.screenshot({ path: path.join(folder, file) })
  await page.close()
  console.log(path.join(folder, file))
}

async function main() {
  const root = path.resolve(__dirname, '../..')
  const bin = path.resolve(process.argv[2] ?? path.join(root, 'build/release/bin'))
  const folder = path.resolve(process.argv[3] ?? path.join(root, 'docs/pictures'))
  const browser = findBrowser()
  if (typeof browser === 'string') throw new Error(browser)
  const session = new PageSession({ disparityd: path.join(bin, 'disparityd'), disparity_web: path.join(bin, 'disparity-web') })
  try {
    session.startDaemon('scene:vga@15')
    const { address } = await session.startWeb()
    await session.startBrowser(browser)
    for (const view of VIEWS) await takePicture(session.browser, address, view, folder)
  } finally {
    await session.end()
  }
}

main().catch(error => {
  console.error(`page_screenshot.cjs: error: ${error.message}`)
  process.exitCode = 1
})
