// SPDX-License-Identifier: Apache-2.0
// Who the viewer is in a session, for the page that is loaded again: its color, and the token with
// which its hand continues as the same participant. The browser's tab keeps it from the end of a page
// to the begin of the next one only, so that a copy of the tab is another person.

interface Person {
  session: string;
  color: string;
  /** Empty: it has not carved. */
  token: string;
  /** How many strokes each gesture has in the block, done and undone; null: it has not carved. */
  gestures: { done: number[]; undone: number[] } | null;
}

const KEY = 'kerf.person';
const NOBODY: Person = { session: '', color: '', token: '', gestures: null };

let person: Person | null = null; // null: not read yet

function take(): Person {
  try {
    const text = sessionStorage.getItem(KEY);
    sessionStorage.removeItem(KEY);
    return text === null ? NOBODY : (JSON.parse(text) as Person);
  } catch {
    return NOBODY; // storage is disabled, or has something else
  }
}

function give(): void {
  try {
    if (person && person.session !== '') sessionStorage.setItem(KEY, JSON.stringify(person));
  } catch {
    // Storage is disabled: the next page is another person.
  }
}

/** The person in this session; with empty fields if it was not here before. */
export function personIn(session: string): Person {
  if (person === null) {
    person = take();
    window.addEventListener('pagehide', give);
    // From the browser's memory the same page comes back, which needs nothing kept.
    window.addEventListener('pageshow', ({ persisted }) => persisted && take());
  }
  if (person.session !== session) person = { ...NOBODY, session };
  return person;
}

/** Notes who the viewer is now. */
export function notePerson(session: string, now: Partial<Omit<Person, 'session'>>): void {
  person = { ...personIn(session), ...now };
}
