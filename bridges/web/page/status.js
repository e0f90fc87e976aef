// SPDX-License-Identifier: Apache-2.0
//
// The numbers of the daemon's status as cards: state, counts, camera, calibration, self-calibration, recording, clients.

import { titleOf } from './place.js'
import { NONE, bytes, counted, fixed, make, showFacts, uptime, write } from './text.js'

const by = id => document.getElementById(id)

/** Shows what the bar at the top says, in its element `pill`. `problem` is the banner's { tone, title, text } or null. */
export function showState(state, tone, problem, pill = by('state')) {
  write(pill, state)
  pill.dataset.tone = tone
  const banner = by('banner')
  banner.hidden = !problem
  document.title = titleOf(problem?.title)
  if (!problem) return
  banner.dataset.tone = problem.tone
  write(by('banner-title'), problem.title)
  write(by('banner-text'), problem.text)
}

/** What is wrong with a daemon that answers, or null. */
export function problemOf(status) {
  if (status.trust?.alarm) return { tone: 'warn', title: 'The frames are not to be trusted', text: status.trust.alarm }
  if (status.state === 'running' || status.state === 'idle') return null
  const camera = status.camera && status.camera.state !== 'streaming' ? `Camera ${status.camera.state.replace('-', ' ')}` : null
  const titles = { waiting: 'Waiting', ended: 'The source has ended', stopping: 'The daemon is stopping' }
  return { tone: 'warn', title: camera ?? titles[status.state] ?? status.state, text: status.detail || 'No frames come.' }
}

/** Shows a status of the daemon; null = there is none. `facts`: what the server has put into words, [title, text, help] each. */
export function showStatus(status, facts) {
  if (!status) return
  write(by('version'), status.server_version)
  write(by('source'), status.source)
  by('source').title = status.source
  by('synthetic').hidden = !status.synthetic
  write(by('rate'), `${fixed(status.rate, 1)} /s`)
  showFacts(by('counts'), countsOf(status))
  showFacts(by('camera'), [...cameraOf(status), ...facts.map(([title, text, help]) => [title[0].toUpperCase() + title.slice(1), text, '', help])])
  showFacts(by('self-calibration'), correctionOf(status.self_calibration))
  showFacts(by('recording'), recordingOf(status.record))
  showNotices(status.notices)
  showClients(status.clients)
}

function countsOf(status) {
  const loss = value => value > 0 ? 'warn' : ''
  return [
    ['Published', counted(status.published)],
    ['Captured', counted(status.captured)],
    ['Dropped', counted(status.dropped), loss(status.dropped), 'By the daemon: matching was slower than the camera'],
    ['Lost by source', counted(status.lost), loss(status.lost)],
    ['Damaged', counted(status.damaged), loss(status.damaged)],
    ...(status.unwanted > 0 ? [['Unwanted', counted(status.unwanted), '', 'Came while nobody wanted frames: [pipeline] on_demand']] : []),
    ...(status.over_budget > 0 ? [['Over the budget', counted(status.over_budget), '', 'Left out to keep within [pipeline] cores']] : []),
    ['Uptime', uptime(status.uptime_s)],
  ]
}

function cameraOf(status) {
  const { camera, geometry } = status
  const rows = []
  if (camera) {
    rows.push(['Camera', [camera.model || 'none found', camera.serial].filter(Boolean).join(', ')],
      ['State', camera.state, camera.state === 'streaming' ? 'good' : 'warn'],
      ['Device', [camera.node, camera.port && `USB ${camera.port}`].filter(Boolean).join(', ') || NONE],
      ['Firmware', camera.firmware || NONE],
      ['Link', camera.speed_mbit > 0 ? `${fixed(camera.speed_mbit, 0)} Mbit/s` : NONE],
      ['Agreed rate', camera.rate > 0 ? `${fixed(camera.rate, 0)} /s` : NONE],
      ['Came back', `${camera.arrivals} found, ${camera.restarts} restarts, ${camera.reopens} reopened, ${camera.resets} resets`],
      ['Bad frames', `${camera.damaged} damaged, ${camera.too_short} too short`, camera.damaged + camera.too_short ? 'warn' : ''])
    if (camera.eyes_apart) {
      const {median_us: apart, drift_ppm: drift} = camera.eyes_apart
      rows.push(['Eyes apart', `${fixed(apart / 1000, 1)} ms, drift ${fixed(drift, 0)} ppm, ${camera.unpaired} unpaired`])
    }
  } else {
    rows.push(['Camera', 'none: the source is not live'])
  }
  rows.push(['Matching', status.method ? `${status.method} on ${status.backend}, ${status.workers} workers` : NONE])
  return [...rows, ...geometryOf(geometry)]
}

function geometryOf(geometry) {
  if (!geometry?.width) return [['Image', NONE]]
  const known = geometry.f > 0 && geometry.baseline_mm > 0
  return [
    ['Image', `${geometry.width} x ${geometry.height} px`],
    ['Disparities', `${geometry.d_min} to ${geometry.d_min + geometry.disparities - 1} px`],
    ['Calibration', known ? geometry.calibration_id : 'none: distances are unknown', known ? '' : 'warn'],
    ['Focal length', known ? `${fixed(geometry.f, 2)} px` : NONE],
    ['Centre', known ? `${fixed(geometry.cx, 1)}, ${fixed(geometry.cy, 1)} px` : NONE],
    ['Baseline', known ? `${fixed(geometry.baseline_mm, 2)} mm` : NONE],
  ]
}

function correctionOf(correction) {
  if (!correction) return [['State', 'off, or nothing to correct']]
  const pixels = value => value > 0 ? `${fixed(value, 3)} px` : 'not measured'
  const rows = [['State', correction.corrected ? `corrected since frame ${correction.since_sequence}` : 'nothing changed',
    correction.corrected ? 'good' : ''], ['Estimating', correction.estimating ? 'yes, in the background' : 'no']]
  if (correction.corrected) {
    const { pitch_degrees: pitch, yaw_degrees: yaw, roll_degrees: roll } = correction
    rows.push(['Pitch, yaw, roll', `${fixed(pitch, 3)}°, ${fixed(yaw, 3)}°, ${fixed(roll, 3)}°`],
      ['Focal ratio', fixed(correction.focal_ratio, 5)])
  }
  return [...rows,
    ['Vertical error', `${pixels(correction.error_before_px)}`, '', 'Between the rows of both eyes, with the factory calibration'],
    ['… corrected', pixels(correction.error_after_px)],
    ['Fitted to', `${counted(correction.frames)} frames, ${counted(correction.matches)} matches`],
    ['Last estimate', correction.detail || NONE]]
}

function recordingOf(record) {
  if (!record?.path) return [['State', 'none yet']]
  const rows = [['State', record.active ? 'recording' : record.removed ? 'ended without a frame, removed' : 'finished', record.active ? 'bad' : ''],
    ['File', record.path],
    ['Length', `${uptime(record.seconds)}, ${counted(record.frames)} frames, ${bytes(record.bytes)}`],
    ['Missing', `${record.dropped} dropped, ${record.lost} lost by the source`, record.dropped + record.lost ? 'warn' : '']]
  return record.error ? [...rows, ['Why it ended', record.error, 'bad']] : rows
}

function showNotices(notices) {
  const list = by('notices')
  if (list.dataset.shown === notices.join('\n')) return
  list.dataset.shown = notices.join('\n')
  list.replaceChildren(...notices.map(notice => make('li', { textContent: notice })))
}

function showClients(clients) {
  write(by('client-count'), String(clients.length))
  const rows = clients.map(client => make('tr', {}, make('td', { textContent: client.name, title: client.address }),
    ...[counted(client.frames_sent), counted(client.frames_skipped), bytes(client.bytes_sent)].map(text => make('td', { textContent: text }))))
  if (!clients.length) return by('clients').replaceChildren(make('p', { className: 'quiet', textContent: 'Nobody over the socket.' }))
  const head = make('tr', {}, ...['Client', 'Frames', 'Skipped', 'Sent'].map(textContent => make('th', { textContent, scope: 'col' })))
  by('clients').replaceChildren(make('table', {}, make('thead', {}, head), make('tbody', {}, ...rows)))
}
