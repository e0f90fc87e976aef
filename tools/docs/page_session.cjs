// SPDX-License-Identifier: Apache-2.0
//
// A daemon, a disparity-web and a browser without a window, for the page's test and its pictures. All of them end with the session.
'use strict'

const { spawn } = require('node:child_process')
const fs = require('node:fs')
const os = require('node:os')
const path = require('node:path')

const LIMIT_MS = 60000 // a machine under load starts slowly; nothing waits this long on a quiet one
const BROWSERS = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome']
// No service of the browser's own may call anybody, and the point cloud is drawn without a graphics processor.
const BROWSER_ARGUMENTS = ['--headless=new', '--disable-gpu', '--enable-unsafe-swiftshader', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync',
  ...(process.getuid?.() === 0 ? ['--no-sandbox'] : [])]

/** Returns { chromium, executablePath }, or a line that says what is missing and how to get it. */
function findBrowser() {
  const folder = process.env.DISPARITYD_NODE_MODULES
  let playwright
  try {
    playwright = require(folder ? path.resolve(folder, 'playwright-core') : 'playwright-core')
  } catch (error) {
    if (error.code !== 'MODULE_NOT_FOUND') throw error
    return 'no playwright-core; npm install --prefix FOLDER playwright-core and set DISPARITYD_NODE_MODULES=FOLDER/node_modules'
  }
  const executablePath = process.env.DISPARITYD_CHROMIUM ?? BROWSERS.find(file => fs.existsSync(file))
  if (!executablePath) return 'no Chromium; apt-get install chromium, or set DISPARITYD_CHROMIUM to its path'
  return { chromium: playwright.chromium, executablePath }
}

/** Calls `check` again and again until it returns something true, which is returned. Throws after LIMIT_MS with `what`. */
async function until(what, check) {
  const end = Date.now() + LIMIT_MS
  for (;;) {
    const result = await check()
    if (result) return result
    if (Date.now() > end) throw new Error(`${what}: not within ${LIMIT_MS / 1000} s`)
    await new Promise(resolve => setTimeout(resolve, 50))
  }
}

class PageSession {
  #running = new Set()
  #log = ''

  /** programs: { disparityd, disparity_web, disparityctl }, their paths. */
  constructor(programs) {
    this.programs = programs
    this.folder = fs.mkdtempSync(path.join(os.tmpdir(), 'disparityd-page-'))
    this.name = `page${process.pid}`
    this.socket = this.#socketOf(this.name)
    process.on('exit', () => this.#endNow())
  }

  /** Starts a daemon on a source. Returns its process; frames come later. Another name is for one beside the session's. */
  startDaemon(source, settings = [], name = this.name) {
    const options = ['scan.enabled=true', 'match.depth_error=true', `socket.unix=${this.#socketOf(name)}`, 'socket.tcp=',
      `record.directory=${this.folder}`, ...settings]
    return this.#start(this.programs.disparityd, ['--source', source, '--name', name, ...options.flatMap(option => ['--set', option])])
  }

  /** Starts disparity-web and waits for its address. Returns { process, address }. */
  startWeb(listen = '127.0.0.1:0', more = ['--allow-control']) {
    return this.#startWeb(['--name', this.name, '--socket', `unix:${this.socket}`, '--listen', listen, ...more])
  }

  /** The same for all daemons of the machine. */
  startWebOfAll(more = []) {
    return this.#startWeb(['--all', '--listen', '127.0.0.1:0', ...more])
  }

  /** Where disparity-web --all looks for a daemon of this name, with XDG_RUNTIME_DIR. */
  #socketOf(name) {
    return path.join(this.folder, `disparityd-${name}.sock`)
  }

  async #startWeb(parameters) {
    const child = this.#start(this.programs.disparity_web, parameters)
    const address = await until('disparity-web prints its address', () => {
      if (child.exitCode !== null) throw new Error(`disparity-web ended with status ${child.exitCode}:\n${this.#log}`)
      return /http:\/\/\S+/.exec(child.printed)?.[0]
    })
    return { process: child, address: address.endsWith('/') ? address : `${address}/` }
  }

  async startBrowser({ chromium, executablePath }) {
    this.browser = await chromium.launch({ executablePath, args: BROWSER_ARGUMENTS })
    return this.browser
  }

  /** Kills a program as a crash would, and waits for its end. */
  async crash(child) {
    const ended = new Promise(resolve => child.once('exit', resolve))
    child.kill('SIGKILL')
    await ended
  }

  /** What all programs have printed, for an error. */
  get log() {
    return this.#log
  }

  async end() {
    await this.browser?.close()
    await Promise.all([...this.#running].map(child => new Promise(resolve => {
      child.once('exit', resolve)
      child.kill('SIGTERM')
    })))
    fs.rmSync(this.folder, { recursive: true, force: true })
  }

  #start(program, parameters) {
    const child = spawn(program, parameters, {
      stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, XDG_RUNTIME_DIR: this.folder } })
    child.printed = ''
    child.stdout.on('data', data => {
      child.printed += data
      this.#log += data
    })
    child.stderr.on('data', data => { this.#log += data })
    child.once('exit', () => this.#running.delete(child))
    this.#running.add(child)
    return child
  }

  #endNow() {
    for (const child of this.#running) child.kill('SIGKILL')
    fs.rmSync(this.folder, { recursive: true, force: true })
  }
}

module.exports = { PageSession, findBrowser, until }
