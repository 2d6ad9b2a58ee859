// Who is signed in, and a way out. Where no token is needed, nothing is shown.

import { request } from './api.js';
import { find, setText } from './dom.js';

export async function showSession() {
  try {
    const caller = await request('/api/v1/caller');
    find('session').hidden = caller.name === '';
    setText(find('caller'), `${caller.name} (${caller.role})`);
  } catch {
    find('session').hidden = true; // the page says itself what is wrong
  }
}
