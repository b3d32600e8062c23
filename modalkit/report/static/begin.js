(() => {
  // Modules stand in the page as text; each becomes an address of its own, once, after those it imports.
  const addresses = new Map();
  const address = (name) => {
    if (!addresses.has(name)) {
      const text = document.querySelector(`script[data-module="${name}"]`).textContent;
      const linked = text.replace(
        /(\bfrom\s*|\bimport\s*)"\.\/([^"]+)"/g,
        (_, word, other) => `${word}"${address(other)}"`,
      );
      addresses.set(name, URL.createObjectURL(new Blob([linked], { type: "text/javascript" })));
    }
    return addresses.get(name);
  };
  const load = (name) => import(address(name));
  const data = JSON.parse(document.getElementById("data").textContent);
  load("page.js").then(
    (page) => page.begin(data, load),
    (error) => console.error(error),
  );
})();
