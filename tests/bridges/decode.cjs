// SPDX-License-Identifier: Apache-2.0
//
// Decodes frames of the bridge with another implementation, the npm package node-mavlink, and compares every field.
//   node decode.cjs PROGRAM
// PROGRAM writes the frames to standard output. Exit status: 0 all is right, 1 something differs, 77 the package is missing:
//   npm install --prefix FOLDER node-mavlink@2.3.0, then DISPARITYD_NODE_MODULES=FOLDER/node_modules
'use strict'

const assert = require('node:assert')
const { execFileSync } = require('node:child_process')
const { Readable } = require('node:stream')

const need = require('../need_package.cjs')('node-mavlink@2.3.0')

function near(value, wanted) {
  assert.ok(Math.abs(value - wanted) < 1e-4, `${value}, expected ${wanted}`)
}

function checkHeartbeat(data) {
  assert.deepStrictEqual([data.customMode, data.type, data.autopilot, data.baseMode, data.systemStatus, data.mavlinkVersion],
    [0, 18, 8, 0, 5, 3])
}

function checkObstacleDistance(data) {
  const distances = new Array(72).fill(65535)
  distances[3] = 1001 // 15 degrees to the right, free
  distances[2] = 345 // 10 degrees to the right
  distances[66] = 600 // 30 degrees to the left
  assert.strictEqual(data.timeUsec, 1234567890123456n)
  assert.deepStrictEqual([...data.distances], distances)
  assert.deepStrictEqual([data.minDistance, data.maxDistance, data.sensorType, data.increment], [25, 1000, 4, 5])
  assert.deepStrictEqual([data.incrementF, data.angleOffset, data.frame], [5, 0, 12])
}

function checkObstacle3d(data, x, y, z) {
  assert.deepStrictEqual([data.timeBootMs, data.obstacleId, data.sensorType, data.frame], [987654321, 65535, 4, 12])
  near(data.minDistance, 0.25)
  near(data.maxDistance, 10)
  near(data.x, x)
  near(data.y, y)
  near(data.z, z)
}

function main() {
  const { createMavLinkStream, minimal, common, ardupilotmega } = need('node-mavlink')
  const registry = { ...minimal.REGISTRY, ...common.REGISTRY, ...ardupilotmega.REGISTRY }
  const checks = [
    [0, checkHeartbeat],
    [330, checkObstacleDistance],
    [11037, data => checkObstacle3d(data, 3.4035, 0.60012, 0.6)], // 3.456 m, 10 degrees to the right, 0.6 m below
    [11037, data => checkObstacle3d(data, 5.19615, -3, 0)], // 6 m, 30 degrees to the left, level
  ]
  let seen = 0
  const stream = createMavLinkStream(Readable.from([execFileSync(process.argv[2])]), {
    onCrcError: () => assert.fail('a checksum is wrong'),
  })
  stream.on('data', packet => {
    const [id, check] = checks[seen]
    assert.strictEqual(packet.header.msgid, id)
    assert.deepStrictEqual([packet.header.sysid, packet.header.compid, packet.header.seq], [42, 196, seen])
    check(packet.protocol.data(packet.payload, registry[id]))
    ++seen
  })
  stream.on('end', () => {
    assert.strictEqual(seen, checks.length)
    console.log(`${seen} frames decoded`)
  })
  process.on('exit', code => { if (code === 0) assert.strictEqual(seen, checks.length) })
}

main()
