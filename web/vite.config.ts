import { readFileSync } from 'node:fs';
import { runnerImport, type Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

/**
 * Makes one file that works without a network: script and styles replace the elements that would load them. The
 * licences of the libraries are added.
 */
function inOneFile(): Plugin {
  return {
    name: 'in-one-file',
    apply: 'build',
    enforce: 'post',
    generateBundle(_, bundle) {
      const page = bundle['index.html'];
      if (page?.type !== 'asset') throw new Error('no index.html was built');
      let html = String(page.source);
      for (const [name, file] of Object.entries(bundle)) {
        if (name === 'index.html') continue;
        const link = new RegExp(
          `<(script|link)[^>]*(?:src|href)="[^"]*${name.replaceAll('.', '\\.')}"[^>]*>(</script>)?`,
        );
        if (!link.test(html)) throw new Error(`${name} is not named by index.html, and one file has no room for it`);
        const inside =
          file.type === 'chunk'
            ? `<script type="module">${file.code.replaceAll('</script', '<\\/script')}</script>`
            : `<style>${String(file.source)}</style>`;
        html = html.replace(link, () => inside);
        delete bundle[name];
      }
      const notices = ['three', 'uplot', 'fflate'].map(
        (name) => `${name}: ${readFileSync(`node_modules/${name}/LICENSE`, 'utf8').trim()}`,
      );
      page.source = html.replace('<html', () => `<!--\nThis page holds:\n\n${notices.join('\n\n')}\n-->\n<html`);
    },
  };
}

/** `npm run dev` shows the demonstration; ISOBATH_SERVE=host:port shows the run of an `isobath serve`. */
function demonstration(): Plugin {
  const serve = async (server: unknown) => {
    if (process.env.ISOBATH_SERVE || process.env.VITEST) return;
    const { module } = await runnerImport<{ serveDemo(server: unknown): void }>('./fixtures/serve.ts');
    module.serveDemo(server);
  };
  return {
    name: 'demonstration',
    configureServer: ({ httpServer }) => serve(httpServer),
    configurePreviewServer: ({ httpServer }) => serve(httpServer),
  };
}

/** The strictest policy that the page must work under; the preview applies it. */
const kPolicy =
  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self'";
const behind = process.env.ISOBATH_SERVE;
const proxy = behind ? { '/socket': { target: `ws://${behind}`, ws: true } } : {};

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    modulePreload: false,
    assetsInlineLimit: 1 << 24,
    chunkSizeWarningLimit: 1000,
  },
  server: { proxy },
  preview: { proxy, headers: { 'Content-Security-Policy': kPolicy } },
  plugins: [inOneFile(), demonstration()],
  test: { include: ['test/*.test.ts'] },
});
