// SPDX-License-Identifier: Apache-2.0
// The servers that the page may not use: its content security policy names those that its own server
// knew when the page was loaded.

const hosts = new Set<string>();

/** Begins to record the hosts that the policy forbids. */
export function watchPolicy(): void {
  document.addEventListener('securitypolicyviolation', ({ blockedURI }) => {
    if (URL.canParse(blockedURI)) hosts.add(new URL(blockedURI).host);
  });
}

/** Whether the policy has forbidden a connection to the server with this origin. */
export function isForbidden(server: string): boolean {
  return hosts.has(new URL(server).host);
}
