// SPDX-License-Identifier: Apache-2.0
//
// Loads npm packages for tests that compare with somebody else's code.
'use strict'

const path = require('node:path')

// Returns a function that loads a package by its name. Without it the test is skipped: exit status 77. `packages` is what
// npm installs for that test.
module.exports = packages => name => {
  const folder = process.env.DISPARITYD_NODE_MODULES
  try {
    return require(folder ? path.resolve(folder, name) : name)
  } catch (error) {
    if (error.code !== 'MODULE_NOT_FOUND') throw error
    console.log(`skipped: no ${name}; npm install --prefix FOLDER ${packages} and set ` +
      'DISPARITYD_NODE_MODULES=FOLDER/node_modules')
    process.exit(77)
  }
}
