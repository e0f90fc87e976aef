// SPDX-License-Identifier: Apache-2.0
//
// Where this page stands: disparity-web --all has a page for each daemon, at /i/NAME/.

const found = /^\/i\/([^/]+)/.exec(location.pathname)

/** What stands before the server's paths that belong to this page's daemon: "/i/front", or "" where there is only one. */
export const BASE = found?.[0] ?? ''

/** That daemon's name; "" where there is only one. */
export const NAME = found?.[1] ?? ''

/** What the browser calls the page: "front – disparityd". `problem`: what comes first, if anything is wrong. */
export function titleOf(problem) {
  return [problem, NAME, 'disparityd'].filter(Boolean).join(' – ')
}
