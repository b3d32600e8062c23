// What is asked of the server: documents by name, at paths relative to the address with its token.

async function answered(response) {
  let document = null;
  try {
    document = await response.json();
  } catch {
    /* not JSON: an error of the server itself */
  }
  if (!response.ok) throw new Error(document?.error ?? `the server answered ${response.status}`);
  return document;
}

async function asked(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new Error("the server does not answer; start it again: all changes are kept");
  }
  return answered(response);
}

export function get(name, parameters = {}) {
  const query = new URLSearchParams(parameters).toString();
  return asked(`api/${name}${query ? `?${query}` : ""}`, {});
}

export function post(name, body = {}) {
  return asked(`api/${name}`, {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify(body),
  });
}
