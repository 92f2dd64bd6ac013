<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE">
<context>
    <name>AircraftBox</name>
    <message>
        <source>From a file ...</source>
        <translation>Aus Datei ...</translation>
    </message>
    <message>
        <source>Aircraft and camera</source>
        <translation>Fluggerät und Kamera</translation>
    </message>
    <message>
        <source>Aircraft (*.toml)</source>
        <translation>Fluggeräte (*.toml)</translation>
    </message>
</context>
<context>
    <name>AirspacePage</name>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>Heights are above the site&apos;s zero. Only the climb above home may be below the airspace.</source>
        <translation>Höhen über dem Nullpunkt des Standorts. Nur der Steigflug über dem Startplatz darf unter dem Luftraum liegen.</translation>
    </message>
    <message>
        <source>Change airspace</source>
        <translation>Luftraum ändern</translation>
    </message>
</context>
<context>
    <name>Axes</name>
    <message>
        <source>East</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>North</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>Höhe</translation>
    </message>
</context>
<context>
    <name>Brief</name>
    <message>
        <source>Page {0} of {1}</source>
        <translation>Seite {0} von {1}</translation>
    </message>
    <message>
        <source>height above take-off [{0}]</source>
        <translation>Höhe über Start [{0}]</translation>
    </message>
    <message>
        <source>time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Flight brief: {0}</source>
        <translation>Flugbriefing: {0}</translation>
    </message>
    <message>
        <source>Take-off and landing</source>
        <translation>Start und Landung</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Set on the remote controller</source>
        <translation>An der Fernsteuerung einstellen</translation>
    </message>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>Before take-off</source>
        <translation>Vor dem Start</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>Height of sortie {0}</source>
        <translation>Höhe von Einsatz {0}</translation>
    </message>
    <message>
        <source>All pre-flight rules are kept: ready to fly.</source>
        <translation>Alle Regeln vor dem Flug sind eingehalten: flugbereit.</translation>
    </message>
    <message>
        <source>Ready to fly, but read the warnings.</source>
        <translation>Flugbereit, aber Warnungen lesen.</translation>
    </message>
    <message>
        <source>NOT ready to fly: see the findings.</source>
        <translation>NICHT flugbereit: siehe Befunde.</translation>
    </message>
    <message>
        <source>Date</source>
        <translation>Datum</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Plan</translation>
    </message>
    <message>
        <source>Aircraft and camera</source>
        <translation>Fluggerät und Kamera</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Batteries needed</source>
        <translation>Benötigte Akkus</translation>
    </message>
    <message>
        <source>Flight time, all sorties</source>
        <translation>Flugzeit, alle Einsätze</translation>
    </message>
    <message>
        <source>Coverage of what can be covered</source>
        <translation>Abdeckung des Erreichbaren</translation>
    </message>
    <message>
        <source>Greatest height above ground</source>
        <translation>Größte Höhe über Boden</translation>
    </message>
    <message>
        <source>{0} along the paths, {1} to be kept</source>
        <translation>{0} entlang der Flugwege, {1} einzuhalten</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>nicht gemessen</translation>
    </message>
    <message>
        <source>Smallest distance to building and obstacles</source>
        <translation>Kleinster Abstand zu Gebäude und Hindernissen</translation>
    </message>
    <message>
        <source>planned for {0}, the aircraft may fly below {1}</source>
        <translation>geplant für {0}, das Fluggerät darf unter {1} fliegen</translation>
    </message>
    <message>
        <source>Wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>Position (WGS 84)</source>
        <translation>Position (WGS 84)</translation>
    </message>
    <message>
        <source>Height above sea level (EGM96)</source>
        <translation>Höhe über Meer (EGM96)</translation>
    </message>
    <message>
        <source>Height above the ellipsoid (WGS 84)</source>
        <translation>Höhe über Ellipsoid (WGS 84)</translation>
    </message>
    <message>
        <source>Height above ground</source>
        <translation>Höhe über Boden</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>Time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Length</source>
        <translation>Flugweg</translation>
    </message>
    <message>
        <source>Battery used</source>
        <translation>Akkuverbrauch</translation>
    </message>
    <message>
        <source>Highest above take-off</source>
        <translation>Höchster Punkt über Start</translation>
    </message>
    <message>
        <source>Highest above sea (EGM96)</source>
        <translation>Höchster Punkt über Meer (EGM96)</translation>
    </message>
    <message>
        <source>Smallest distance</source>
        <translation>Kleinster Abstand</translation>
    </message>
    <message>
        <source>The plan has no sorties.</source>
        <translation>Der Plan hat keine Einsätze.</translation>
    </message>
    <message>
        <source>Return height, above take-off</source>
        <translation>Rückkehrhöhe, über Start</translation>
    </message>
    <message>
        <source>not known</source>
        <translation>unbekannt</translation>
    </message>
    <message>
        <source>fly the mission to its end</source>
        <translation>Mission zu Ende fliegen</translation>
    </message>
    <message>
        <source>return home straight, at the return height</source>
        <translation>direkt zum Startplatz zurück, in Rückkehrhöhe</translation>
    </message>
    <message>
        <source>Without radio link</source>
        <translation>Ohne Funkverbindung</translation>
    </message>
    <message>
        <source>Battery reserve at landing</source>
        <translation>Akkureserve bei der Landung</translation>
    </message>
    <message>
        <source>Highest speed</source>
        <translation>Höchste Geschwindigkeit</translation>
    </message>
    <message>
        <source>Hover before each photo</source>
        <translation>Halt vor jedem Foto</translation>
    </message>
    <message>
        <source>None: every rule is kept.</source>
        <translation>Keine: Jede Regel ist eingehalten.</translation>
    </message>
    <message>
        <source>ERROR</source>
        <translation>FEHLER</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Severity</source>
        <translation>Stufe</translation>
    </message>
    <message>
        <source>Finding</source>
        <translation>Befund</translation>
    </message>
    <message>
        <source>Measured</source>
        <translation>Gemessen</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Ort</translation>
    </message>
    <message>
        <source>Permission for this place and height is at hand; nobody is below the paths</source>
        <translation>Genehmigung für diesen Ort und diese Höhe liegt vor; niemand ist unter den Flugwegen</translation>
    </message>
    <message>
        <source>No-fly zones known to everybody: {0}</source>
        <translation>Flugverbotszonen, allen bekannt: {0}</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>Nothing stands within {0} of the paths but what the site knows (building; obstacles: {1})</source>
        <translation>Innerhalb von {0} um die Flugwege steht nur, was der Standort kennt (Gebäude; Hindernisse: {1})</translation>
    </message>
    <message>
        <source>Fully charged batteries: {0}; free space for photos: {1}</source>
        <translation>Voll geladene Akkus: {0}; freier Speicher für Fotos: {1}</translation>
    </message>
    <message>
        <source>Aircraft stands on the take-off point; GNSS (RTK where there is one) has a fix, compass is calibrated</source>
        <translation>Fluggerät steht auf dem Startplatz; GNSS (RTK, falls vorhanden) hat einen Fix, Kompass ist kalibriert</translation>
    </message>
    <message>
        <source>Return height on the remote controller is at least {0} above take-off</source>
        <translation>Rückkehrhöhe an der Fernsteuerung ist mindestens {0} über Start</translation>
    </message>
    <message>
        <source>Wind at flight height is below {0}</source>
        <translation>Wind in Flughöhe ist unter {0}</translation>
    </message>
    <message>
        <source>The mission on the remote controller is this plan (photos: {0})</source>
        <translation>Die Mission auf der Fernsteuerung ist dieser Plan (Fotos: {0})</translation>
    </message>
    <message>
        <source>Focus, exposure and white balance are fixed on the facade</source>
        <translation>Fokus, Belichtung und Weißabgleich sind auf der Fassade fest eingestellt</translation>
    </message>
</context>
<context>
    <name>BriefDialog</name>
    <message>
        <source>Flight brief</source>
        <translation>Flugbriefing</translation>
    </message>
    <message>
        <source>A4</source>
        <translation>A4</translation>
    </message>
    <message>
        <source>US Letter</source>
        <translation>US Letter</translation>
    </message>
    <message>
        <source>Save as PDF ...</source>
        <translation>Als PDF speichern ...</translation>
    </message>
    <message>
        <source>Print ...</source>
        <translation>Drucken ...</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Paper</source>
        <translation>Papier</translation>
    </message>
    <message>
        <source>Drawing the map and the profiles ...</source>
        <translation>Karte und Profile werden gezeichnet ...</translation>
    </message>
    <message>
        <source>Written: {0}</source>
        <translation>Geschrieben: {0}</translation>
    </message>
    <message>
        <source>Save the flight brief</source>
        <translation>Flugbriefing speichern</translation>
    </message>
    <message>
        <source>PDF (*.pdf)</source>
        <translation>PDF (*.pdf)</translation>
    </message>
</context>
<context>
    <name>CameraPreview</name>
    <message>
        <source>Play</source>
        <translation>Abspielen</translation>
    </message>
    <message>
        <source>Fly through the sortie (space bar)</source>
        <translation>Den Einsatz abfliegen (Leertaste)</translation>
    </message>
    <message>
        <source>The sortie that is flown</source>
        <translation>Der Einsatz, der abgeflogen wird</translation>
    </message>
    <message>
        <source>How many times faster than the flight</source>
        <translation>Um wie viel schneller als der Flug</translation>
    </message>
    <message>
        <source>{0}x</source>
        <translation>{0}x</translation>
    </message>
    <message>
        <source>No plan yet: make or open one, then choose a viewpoint.</source>
        <translation>Noch kein Plan: einen erstellen oder öffnen, dann einen Aufnahmepunkt wählen.</translation>
    </message>
    <message>
        <source>{0}: covers no panel</source>
        <translation>{0}: deckt keine Scheibe ab</translation>
    </message>
    <message>
        <source>{0}: covers {1} panels
{2}</source>
        <translation>{0}: abgedeckte Scheiben: {1}
{2}</translation>
    </message>
    <message>
        <source>before the first photo</source>
        <translation>vor dem ersten Foto</translation>
    </message>
    <message>
        <source>on the way from {0}</source>
        <translation>unterwegs ab {0}</translation>
    </message>
    <message>
        <source>nearest panel {0}: {1} away, {2} per pixel, seen at {3:.0f}° from its normal
picture at this distance: {4} x {5}</source>
        <translation>nächste Scheibe {0}: {1} entfernt, {2} je Pixel, gesehen {3:.0f}° neben ihrer Normalen
Bild in dieser Entfernung: {4} x {5}</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>The path of this sortie misses one of its viewpoints.</source>
        <translation>Der Flugweg dieses Einsatzes verfehlt einen seiner Aufnahmepunkte.</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pause</translation>
    </message>
    <message>
        <source>Time of the sortie</source>
        <translation>Zeit im Einsatz</translation>
    </message>
    <message>
        <source>{0} of {1}</source>
        <translation>{0} von {1}</translation>
    </message>
</context>
<context>
    <name>ClearanceChart</name>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>distance flown in {0}</source>
        <translation>Flugweg in {0}</translation>
    </message>
    <message>
        <source>in {0}</source>
        <translation>in {0}</translation>
    </message>
    <message>
        <source>No route to measure yet.</source>
        <translation>Noch keine Route zum Messen.</translation>
    </message>
    <message>
        <source>Smallest clearance {0} (must be {1}); further than {2} is cut off</source>
        <translation>Kleinster Abstand {0} (Soll {1}); über {2} abgeschnitten</translation>
    </message>
    <message>
        <source>; from no-fly volumes {0} (dotted)</source>
        <translation>; zu Flugverbotszonen {0} (gepunktet)</translation>
    </message>
</context>
<context>
    <name>CompareWindow</name>
    <message>
        <source>Compare plans</source>
        <translation>Pläne vergleichen</translation>
    </message>
    <message>
        <source>coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>difference in coverage</source>
        <translation>Unterschied der Abdeckung</translation>
    </message>
    <message>
        <source>pixel size</source>
        <translation>Pixelgröße</translation>
    </message>
    <message>
        <source>Panels by</source>
        <translation>Scheiben nach</translation>
    </message>
    <message>
        <source>Plans compared</source>
        <translation>Verglichene Pläne</translation>
    </message>
    <message>
        <source>auto</source>
        <translation>auto</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>All plans judged with {0:g} degree sections, {1}, occlusion {2}. A star marks the better.</source>
        <translation>Alle Pläne beurteilt mit Sektoren von {0:g} Grad, {1}, Verdeckung {2}. Ein Stern markiert den besseren.</translation>
    </message>
    <message>
        <source>{0:.1f} s</source>
        <translation>{0:.1f} s</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Time in the air</source>
        <translation>Zeit in der Luft</translation>
    </message>
    <message>
        <source>Way flown</source>
        <translation>Flugweg</translation>
    </message>
    <message>
        <source>Views found after</source>
        <translation>Aufnahmen gefunden nach</translation>
    </message>
    <message>
        <source>Sections covered</source>
        <translation>Abgedeckte Sektoren</translation>
    </message>
    <message>
        <source>of all sections</source>
        <translation>von allen Sektoren</translation>
    </message>
    <message>
        <source>of what can be covered</source>
        <translation>vom Erreichbaren</translation>
    </message>
    <message>
        <source>Facade {0}, of what can be covered</source>
        <translation>Fassade {0}, vom Erreichbaren</translation>
    </message>
    <message>
        <source>Sections no other plan covers</source>
        <translation>Sektoren nur in diesem Plan</translation>
    </message>
    <message>
        <source>Covered at least {0} times</source>
        <translation>Mindestens {0}-mal abgedeckt</translation>
    </message>
    <message>
        <source>Finest pixel</source>
        <translation>Feinstes Pixel</translation>
    </message>
    <message>
        <source>Coarsest pixel</source>
        <translation>Gröbstes Pixel</translation>
    </message>
    <message>
        <source>Finest pixel on the worst panel</source>
        <translation>Feinstes Pixel der schlechtesten Scheibe</translation>
    </message>
    <message>
        <source>Smallest clearance</source>
        <translation>Kleinster Abstand</translation>
    </message>
    <message>
        <source>Findings: {0}</source>
        <translation>Befunde: {0}</translation>
    </message>
    <message>
        <source>Covered of what is possible</source>
        <translation>Abgedeckt vom Erreichbaren</translation>
    </message>
    <message>
        <source>Sections more than the other</source>
        <translation>Sektoren mehr als der andere</translation>
    </message>
</context>
<context>
    <name>ComparisonView</name>
    <message>
        <source>Also what is the same</source>
        <translation>Auch Gleiches zeigen</translation>
    </message>
    <message>
        <source>Differences</source>
        <translation>Unterschiede</translation>
    </message>
    <message>
        <source>Photo</source>
        <translation>Foto</translation>
    </message>
    <message>
        <source>Viewpoint</source>
        <translation>Aufnahmepunkt</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>In the file</source>
        <translation>In der Datei</translation>
    </message>
    <message>
        <source>Moved [{0}]</source>
        <translation>Verschoben [{0}]</translation>
    </message>
    <message>
        <source>Turned [°]</source>
        <translation>Gedreht [°]</translation>
    </message>
    <message>
        <source>Tilted [°]</source>
        <translation>Geneigt [°]</translation>
    </message>
    <message>
        <source>Order</source>
        <translation>Reihenfolge</translation>
    </message>
    <message>
        <source>the same</source>
        <translation>gleich</translation>
    </message>
    <message>
        <source>changed</source>
        <translation>geändert</translation>
    </message>
    <message>
        <source>missing in the file</source>
        <translation>fehlt in der Datei</translation>
    </message>
    <message>
        <source>not planned</source>
        <translation>nicht geplant</translation>
    </message>
    <message>
        <source>out of order</source>
        <translation>falsche Reihenfolge</translation>
    </message>
    <message>
        <source>&quot;Compare with file&quot; reads a mission file back and shows what differs.</source>
        <translation>„Mit Datei vergleichen“ liest eine Missionsdatei zurück und zeigt, was abweicht.</translation>
    </message>
    <message>
        <source>{0} is the plan: all {1} photos, in order, along the same path.</source>
        <translation>{0} ist der Plan: alle {1} Fotos, in richtiger Reihenfolge, auf demselben Flugweg.</translation>
    </message>
    <message>
        <source>{0} has all {1} photos of the plan, in order. It holds no path to compare.</source>
        <translation>{0} hat alle {1} Fotos des Plans in richtiger Reihenfolge. Ein Flugweg zum Vergleichen fehlt.</translation>
    </message>
    <message>
        <source>{0} takes all {1} photos of the plan, but flies otherwise: {2} out of order</source>
        <translation>{0} macht alle {1} Fotos der Planung, fliegt aber anders: {2} in anderer Reihenfolge</translation>
    </message>
    <message>
        <source>{0} is NOT the plan: {1} photos the same, {2} changed, {3} missing, {4} not planned, {5} out of order</source>
        <translation>{0} ist NICHT der Plan: {1} Fotos gleich, {2} geändert, {3} fehlend, {4} nicht geplant, {5} in falscher Reihenfolge</translation>
    </message>
    <message>
        <source>{0}; the paths are up to {1} apart.</source>
        <translation>{0}; die Flugwege weichen bis zu {1} ab.</translation>
    </message>
</context>
<context>
    <name>Desk</name>
    <message>
        <source>{0}. The settings of the first start are used; the file stays as it is.</source>
        <translation>{0}. Es gelten die Einstellungen des ersten Starts; die Datei bleibt, wie sie ist.</translation>
    </message>
    <message>
        <source>Something is running: the language changes when Reflight is started next.</source>
        <translation>Etwas läuft noch: Die Sprache wechselt beim nächsten Start von Reflight.</translation>
    </message>
    <message>
        <source>New project</source>
        <translation>Neues Projekt</translation>
    </message>
    <message>
        <source>Map tiles</source>
        <translation>Kartenkacheln</translation>
    </message>
    <message>
        <source>Map tiles (*.mbtiles)</source>
        <translation>Kartenkacheln (*.mbtiles)</translation>
    </message>
    <message>
        <source>The settings could not be kept: {0}</source>
        <translation>Die Einstellungen ließen sich nicht sichern: {0}</translation>
    </message>
    <message>
        <source>Open project</source>
        <translation>Projekt öffnen</translation>
    </message>
    <message>
        <source>{0}: this folder is not there any more; was it moved or renamed?</source>
        <translation>{0}: Dieser Ordner ist nicht mehr da; wurde er verschoben oder umbenannt?</translation>
    </message>
    <message>
        <source>Save project as</source>
        <translation>Projekt speichern unter</translation>
    </message>
    <message>
        <source>Saved in {0}</source>
        <translation>Gespeichert in {0}</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>{0}: {1} panels, {2} plans</source>
        <translation>{0}: Scheiben {1}, Pläne {2}</translation>
    </message>
</context>
<context>
    <name>EffectsDesk</name>
    <message>
        <source>Look at the scene</source>
        <translation>Szene auswerten</translation>
    </message>
</context>
<context>
    <name>EffectsPanel</name>
    <message>
        <source>Open a site, and what its scene calls for stands here.</source>
        <translation>Einen Standort öffnen; dann steht hier, was seine Szene verlangt.</translation>
    </message>
</context>
<context>
    <name>ExportDialog</name>
    <message>
        <source>Export mission files</source>
        <translation>Missionsdateien exportieren</translation>
    </message>
    <message>
        <source>Write ...</source>
        <translation>Schreiben ...</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Exportieren</translation>
    </message>
    <message>
        <source>Making the files ...</source>
        <translation>Dateien werden erstellt ...</translation>
    </message>
    <message>
        <source>Prepare export</source>
        <translation>Export vorbereiten</translation>
    </message>
    <message>
        <source>No objections to these files.</source>
        <translation>Keine Einwände gegen diese Dateien.</translation>
    </message>
    <message>
        <source>Cannot be exported: {0}</source>
        <translation>Export nicht möglich: {0}</translation>
    </message>
    <message>
        <source>Not to be written like this: see the errors.</source>
        <translation>So nicht zu schreiben: siehe die Fehler.</translation>
    </message>
    <message>
        <source>Ready to be written, files: {0}. Read the warnings.</source>
        <translation>Bereit zum Schreiben, Dateien: {0}. Warnungen lesen.</translation>
    </message>
    <message>
        <source>Ready to be written, files: {0}</source>
        <translation>Bereit zum Schreiben, Dateien: {0}</translation>
    </message>
    <message>
        <source>Write mission files</source>
        <translation>Missionsdateien schreiben</translation>
    </message>
    <message>
        <source>Mission files (*{0})</source>
        <translation>Missionsdateien (*{0})</translation>
    </message>
    <message>
        <source>Replace files?</source>
        <translation>Dateien ersetzen?</translation>
    </message>
    <message>
        <source>These files are replaced: {0}</source>
        <translation>Diese Dateien werden ersetzt: {0}</translation>
    </message>
    <message>
        <source>Written: {0}</source>
        <translation>Geschrieben: {0}</translation>
    </message>
    <message>
        <source>Not written: {0}</source>
        <translation>Nicht geschrieben: {0}</translation>
    </message>
</context>
<context>
    <name>ExportForm</name>
    <message>
        <source>above everything on the site</source>
        <translation>über allem am Standort</translation>
    </message>
    <message>
        <source>Format</source>
        <translation>Format</translation>
    </message>
    <message>
        <source>Heights in the file</source>
        <translation>Höhen in der Datei</translation>
    </message>
    <message>
        <source>Autopilot</source>
        <translation>Autopilot</translation>
    </message>
    <message>
        <source>Without radio link</source>
        <translation>Ohne Funkverbindung</translation>
    </message>
    <message>
        <source>Return height</source>
        <translation>Rückkehrhöhe</translation>
    </message>
    <message>
        <source>Above take-off</source>
        <translation>Über Start</translation>
    </message>
    <message>
        <source>DJI (.kmz)</source>
        <translation>DJI (.kmz)</translation>
    </message>
    <message>
        <source>QGroundControl (.plan)</source>
        <translation>QGroundControl (.plan)</translation>
    </message>
    <message>
        <source>Mission Planner (.waypoints)</source>
        <translation>Mission Planner (.waypoints)</translation>
    </message>
    <message>
        <source>Google Earth (.kml), to look at</source>
        <translation>Google Earth (.kml), zum Ansehen</translation>
    </message>
    <message>
        <source>Table of photos (.csv)</source>
        <translation>Tabelle der Fotos (.csv)</translation>
    </message>
    <message>
        <source>by aircraft</source>
        <translation>nach Fluggerät</translation>
    </message>
    <message>
        <source>fly the mission to its end</source>
        <translation>Mission zu Ende fliegen</translation>
    </message>
    <message>
        <source>return home straight</source>
        <translation>direkt zum Startplatz zurück</translation>
    </message>
    <message>
        <source>above take-off</source>
        <translation>über Start</translation>
    </message>
    <message>
        <source>above sea level (EGM96)</source>
        <translation>über Meer (EGM96)</translation>
    </message>
    <message>
        <source>above ellipsoid (WGS 84)</source>
        <translation>über Ellipsoid (WGS 84)</translation>
    </message>
</context>
<context>
    <name>ExtentBox</name>
    <message>
        <source>from</source>
        <translation>von</translation>
    </message>
    <message>
        <source>to</source>
        <translation>bis</translation>
    </message>
</context>
<context>
    <name>FacadePage</name>
    <message>
        <source>Facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>Turn to the other side</source>
        <translation>Auf die andere Seite drehen</translation>
    </message>
    <message>
        <source>Panels: {0}, {1} of glass
Faces: {2}</source>
        <translation>Scheiben: {0}, {1} Glas
Blickrichtung: {2}</translation>
    </message>
    <message>
        <source>up</source>
        <translation>nach oben</translation>
    </message>
    <message>
        <source>down</source>
        <translation>nach unten</translation>
    </message>
    <message>
        <source>Turn facade {0}</source>
        <translation>Fassade {0} drehen</translation>
    </message>
</context>
<context>
    <name>FindingsList</name>
    <message>
        <source>Findings</source>
        <translation>Befunde</translation>
    </message>
    <message>
        <source>Error</source>
        <translation>Fehler</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Kept</source>
        <translation>Eingehalten</translation>
    </message>
    <message>
        <source>Click to see the place</source>
        <translation>Klicken zeigt den Ort</translation>
    </message>
    <message>
        <source>{0} ({1})</source>
        <translation>{0} ({1})</translation>
    </message>
    <message>
        <source>measured {0}</source>
        <translation>gemessen {0}</translation>
    </message>
    <message>
        <source>limit {0}</source>
        <translation>Grenze {0}</translation>
    </message>
    <message>
        <source>at {0}</source>
        <translation>bei {0}</translation>
    </message>
    <message>
        <source>The site is being checked ...</source>
        <translation>Der Standort wird geprüft ...</translation>
    </message>
    <message>
        <source>Home, airspace and facades: nothing wrong found.</source>
        <translation>Startplatz, Luftraum und Fassaden: nichts zu beanstanden.</translation>
    </message>
    <message>
        <source>The site&apos;s check found: {0}</source>
        <translation>Befunde der Standortprüfung: {0}</translation>
    </message>
</context>
<context>
    <name>FindingsView</name>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Measure every pre-flight rule again</source>
        <translation>Jede Regel vor dem Flug neu messen</translation>
    </message>
    <message>
        <source>Not checked yet.</source>
        <translation>Noch nicht geprüft.</translation>
    </message>
    <message>
        <source>Nothing stands against the flight. The button with the tick lists the rules that are kept.</source>
        <translation>Nichts spricht gegen den Flug. Die Taste mit dem Haken zeigt die eingehaltenen Regeln.</translation>
    </message>
    <message>
        <source>Older than the plan: it was changed after this check.</source>
        <translation>Älter als der Plan: Er wurde nach dieser Prüfung geändert.</translation>
    </message>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>Readiness not known</source>
        <translation>Flugbereitschaft unbekannt</translation>
    </message>
    <message>
        <source>Ready to fly</source>
        <translation>Flugbereit</translation>
    </message>
    <message>
        <source>NOT ready to fly</source>
        <translation>NICHT flugbereit</translation>
    </message>
</context>
<context>
    <name>GridForm</name>
    <message>
        <source>How far the panels may lie from the building&apos;s mesh</source>
        <translation>Wie weit die Scheiben neben dem Gebäudenetz liegen dürfen</translation>
    </message>
    <message>
        <source>Pick the rectangle on the wall</source>
        <translation>Rechteck an der Wand wählen</translation>
    </message>
    <message>
        <source>Add these panels</source>
        <translation>Diese Scheiben hinzufügen</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>Zeilen</translation>
    </message>
    <message>
        <source>Columns</source>
        <translation>Spalten</translation>
    </message>
    <message>
        <source>Gap</source>
        <translation>Fuge</translation>
    </message>
    <message>
        <source>Off the wall by up to</source>
        <translation>Abweichung von der Wand bis</translation>
    </message>
    <message>
        <source>Lower left</source>
        <translation>Unten links</translation>
    </message>
    <message>
        <source>Lower right</source>
        <translation>Unten rechts</translation>
    </message>
    <message>
        <source>Upper left</source>
        <translation>Oben links</translation>
    </message>
    <message>
        <source>Rows and columns</source>
        <translation>Zeilen und Spalten</translation>
    </message>
    <message>
        <source>Rectangle</source>
        <translation>Rechteck</translation>
    </message>
    <message>
        <source>Three clicks: lower left, lower right, upper edge, as seen from outside.</source>
        <translation>Drei Klicks: unten links, unten rechts, Oberkante, von außen gesehen.</translation>
    </message>
    <message>
        <source>Wall: {0} × {1}
Panels: {2}, each {3} × {4}</source>
        <translation>Wand: {0} × {1}
Scheiben: {2}, je {3} × {4}</translation>
    </message>
</context>
<context>
    <name>GridMaker</name>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>Check the panel grid</source>
        <translation>Scheibenraster prüfen</translation>
    </message>
    <message>
        <source>The panels lie on the building and look outwards.</source>
        <translation>Die Scheiben liegen am Gebäude und zeigen nach außen.</translation>
    </message>
    <message>
        <source>Add panel grid {0}</source>
        <translation>Scheibenraster {0} hinzufügen</translation>
    </message>
</context>
<context>
    <name>HemisphereView</name>
    <message>
        <source>Click a panel to see from where it is photographed.</source>
        <translation>Eine Scheibe anklicken, um zu sehen, von wo sie fotografiert wird.</translation>
    </message>
</context>
<context>
    <name>HomePage</name>
    <message>
        <source>Put it on the ground</source>
        <translation>Auf den Boden setzen</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Move home</source>
        <translation>Startplatz versetzen</translation>
    </message>
    <message>
        <source>Put home on the ground</source>
        <translation>Startplatz auf den Boden setzen</translation>
    </message>
</context>
<context>
    <name>ImportDialog</name>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>Use these panels</source>
        <translation>Diese Scheiben übernehmen</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>Verwerfen</translation>
    </message>
    <message>
        <source>Preview again</source>
        <translation>Neue Vorschau</translation>
    </message>
    <message>
        <source>Import</source>
        <translation>Importieren</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Panel grid</source>
        <translation>Scheibenraster</translation>
    </message>
    <message>
        <source>Reading {0} ...</source>
        <translation>{0} wird gelesen ...</translation>
    </message>
    <message>
        <source>Preview {0}</source>
        <translation>Vorschau {0}</translation>
    </message>
    <message>
        <source>Reading failed; see the messages in the main window.</source>
        <translation>Lesen fehlgeschlagen; siehe Meldungen im Hauptfenster.</translation>
    </message>
    <message>
        <source>Reading {0}: {1} ...</source>
        <translation>{0} wird gelesen: {1} ...</translation>
    </message>
    <message>
        <source>The options were changed: press “Preview again”.</source>
        <translation>Die Optionen wurden geändert: „Neue Vorschau“ drücken.</translation>
    </message>
    <message>
        <source>Checking ...</source>
        <translation>Wird geprüft ...</translation>
    </message>
    <message>
        <source>The panels lie on the building and look outwards.</source>
        <translation>Die Scheiben liegen am Gebäude und zeigen nach außen.</translation>
    </message>
    <message>
        <source>Check the panel grid</source>
        <translation>Scheibenraster prüfen</translation>
    </message>
</context>
<context>
    <name>ImportForm</name>
    <message>
        <source>As the file suggests</source>
        <translation>Wie die Datei nahelegt</translation>
    </message>
    <message>
        <source>as the file says</source>
        <translation>laut Datei</translation>
    </message>
    <message>
        <source>As usual for the format</source>
        <translation>Wie im Format üblich</translation>
    </message>
    <message>
        <source>Zero point on earth</source>
        <translation>Nullpunkt auf der Erde</translation>
    </message>
    <message>
        <source>Coordinate system</source>
        <translation>Koordinatensystem</translation>
    </message>
    <message>
        <source>As the file says</source>
        <translation>Laut Datei</translation>
    </message>
    <message>
        <source>Found out</source>
        <translation>Automatisch</translation>
    </message>
    <message>
        <source>East first</source>
        <translation>Ost zuerst</translation>
    </message>
    <message>
        <source>North first</source>
        <translation>Nord zuerst</translation>
    </message>
    <message>
        <source>As the system says</source>
        <translation>Laut System</translation>
    </message>
    <message>
        <source>Above sea level</source>
        <translation>Über Meer</translation>
    </message>
    <message>
        <source>Above the ellipsoid</source>
        <translation>Über Ellipsoid</translation>
    </message>
    <message>
        <source>Building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>Unit of lengths</source>
        <translation>Längeneinheit</translation>
    </message>
    <message>
        <source>Axis that points up</source>
        <translation>Achse nach oben</translation>
    </message>
    <message>
        <source>Place on earth</source>
        <translation>Lage auf der Erde</translation>
    </message>
    <message>
        <source>Code of the system</source>
        <translation>Code des Systems</translation>
    </message>
    <message>
        <source>Order of coordinates</source>
        <translation>Koordinatenfolge</translation>
    </message>
    <message>
        <source>Heights are</source>
        <translation>Höhen sind</translation>
    </message>
    <message>
        <source>Airspace around the building</source>
        <translation>Luftraum um das Gebäude</translation>
    </message>
    <message>
        <source>Name of the site</source>
        <translation>Name des Standorts</translation>
    </message>
    <message>
        <source>Airspace up to, in the Site tab</source>
        <translation>Luftraum bis, im Reiter Standort</translation>
    </message>
    <message>
        <source>Airspace up from, in the Site tab</source>
        <translation>Luftraum von, im Reiter Standort</translation>
    </message>
    <message>
        <source>Gap</source>
        <translation>Fuge</translation>
    </message>
    <message>
        <source>Off the wall by up to</source>
        <translation>Abweichung von der Wand bis</translation>
    </message>
    <message>
        <source>Home, in the Site tab</source>
        <translation>Startplatz, im Reiter Standort</translation>
    </message>
    <message>
        <source>Columns</source>
        <translation>Spalten</translation>
    </message>
    <message>
        <source>Rows</source>
        <translation>Zeilen</translation>
    </message>
    <message>
        <source>Panel grid</source>
        <translation>Scheibenraster</translation>
    </message>
    <message>
        <source>{0}: windows {1}, {2}</source>
        <translation>{0}: Fenster {1}, {2}</translation>
    </message>
</context>
<context>
    <name>ImportTexts</name>
    <message>
        <source>Size {0} (east × north × up); triangles: {1}</source>
        <translation>Größe {0} (Ost × Nord × Höhe); Dreiecke: {1}</translation>
    </message>
    <message>
        <source>Zero at {0:.6f}°, {1:.6f}°, {2} above the ellipsoid, {3} above sea level (EGM96)</source>
        <translation>Nullpunkt bei {0:.6f}°, {1:.6f}°, {2} über Ellipsoid, {3} über Meer (EGM96)</translation>
    </message>
    <message>
        <source>{0} smaller ones</source>
        <translation>{0} kleinere</translation>
    </message>
    <message>
        <source>Panels: {0}, {1} of glass; by facade: {2}</source>
        <translation>Scheiben: {0}, {1} Glas; nach Fassade: {2}</translation>
    </message>
</context>
<context>
    <name>ItemPage</name>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Rename {0}</source>
        <translation>{0} umbenennen</translation>
    </message>
    <message>
        <source>Remove {0}</source>
        <translation>{0} entfernen</translation>
    </message>
</context>
<context>
    <name>JobBar</name>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
    <message>
        <source>Throw the running job away</source>
        <translation>Laufende Aufgabe verwerfen</translation>
    </message>
    <message>
        <source>{0}: cancelling ...</source>
        <translation>{0}: wird abgebrochen ...</translation>
    </message>
    <message>
        <source>{0} waiting</source>
        <translation>{0} wartend</translation>
    </message>
    <message>
        <source>{0:.0f} s</source>
        <translation>{0:.0f} s</translation>
    </message>
    <message>
        <source>{0:.0f} s left</source>
        <translation>noch {0:.0f} s</translation>
    </message>
    <message>
        <source>Cancel: {0}</source>
        <translation>Abbrechen: {0}</translation>
    </message>
</context>
<context>
    <name>MainWindow</name>
    <message>
        <source>{0} (Ctrl+{1})</source>
        <translation>{0} (Strg+{1})</translation>
    </message>
</context>
<context>
    <name>MapView</name>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>This site lies beyond the end of web maps (85.05 degrees); use the 3-D view.</source>
        <translation>Dieser Standort liegt jenseits des Randes von Webkarten (85.05 Grad); die 3D-Ansicht nutzen.</translation>
    </message>
    <message>
        <source>No map is loaded. &quot;Map file&quot; opens one (MBTiles); no network is used.</source>
        <translation>Keine Karte geladen. „Kartendatei“ öffnet eine (MBTiles); ohne Netzzugriff.</translation>
    </message>
    <message>
        <source>The map &quot;{0}&quot; does not cover this place.</source>
        <translation>Die Karte „{0}“ enthält diesen Ort nicht.</translation>
    </message>
    <message>
        <source>Nearer (+)</source>
        <translation>Näher (+)</translation>
    </message>
    <message>
        <source>Further away (-)</source>
        <translation>Weiter weg (-)</translation>
    </message>
    <message>
        <source>Fit</source>
        <translation>Einpassen</translation>
    </message>
    <message>
        <source>Show the whole site (F)</source>
        <translation>Ganzen Standort zeigen (F)</translation>
    </message>
    <message>
        <source>Map file</source>
        <translation>Kartendatei</translation>
    </message>
    <message>
        <source>Open an MBTiles file to put under the site</source>
        <translation>MBTiles-Datei öffnen und unter den Standort legen</translation>
    </message>
    <message>
        <source>Open map</source>
        <translation>Karte öffnen</translation>
    </message>
    <message>
        <source>Offline maps (*.mbtiles);;All files (*)</source>
        <translation>Offline-Karten (*.mbtiles);;Alle Dateien (*)</translation>
    </message>
</context>
<context>
    <name>Menus</name>
    <message>
        <source>&amp;Project</source>
        <translation>&amp;Projekt</translation>
    </message>
    <message>
        <source>&amp;Edit</source>
        <translation>&amp;Bearbeiten</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>&amp;Ansicht</translation>
    </message>
    <message>
        <source>&amp;Go</source>
        <translation>&amp;Gehe zu</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>&amp;Hilfe</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Rückgängig</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wiederholen</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Speichern</translation>
    </message>
    <message>
        <source>&amp;New project</source>
        <translation>&amp;Neues Projekt</translation>
    </message>
    <message>
        <source>&amp;Open project ...</source>
        <translation>Projekt &amp;öffnen ...</translation>
    </message>
    <message>
        <source>Open &amp;recent</source>
        <translation>&amp;Zuletzt geöffnet</translation>
    </message>
    <message>
        <source>&amp;Save</source>
        <translation>&amp;Speichern</translation>
    </message>
    <message>
        <source>Save &amp;as ...</source>
        <translation>Speichern &amp;unter ...</translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation>&amp;Beenden</translation>
    </message>
    <message>
        <source>&amp;Undo</source>
        <translation>&amp;Rückgängig</translation>
    </message>
    <message>
        <source>&amp;Redo</source>
        <translation>&amp;Wiederholen</translation>
    </message>
    <message>
        <source>&amp;3-D view</source>
        <translation>&amp;3D-Ansicht</translation>
    </message>
    <message>
        <source>&amp;Map</source>
        <translation>&amp;Karte</translation>
    </message>
    <message>
        <source>&amp;Camera preview</source>
        <translation>Ka&amp;meravorschau</translation>
    </message>
    <message>
        <source>As the desktop</source>
        <translation>Wie das System</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>Hell</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>Dunkel</translation>
    </message>
    <message>
        <source>Bright sun</source>
        <translation>Helle Sonne</translation>
    </message>
    <message>
        <source>Metres</source>
        <translation>Meter</translation>
    </message>
    <message>
        <source>Feet</source>
        <translation>Fuß</translation>
    </message>
    <message>
        <source>&amp;Theme</source>
        <translation>&amp;Design</translation>
    </message>
    <message>
        <source>&amp;Units</source>
        <translation>&amp;Einheiten</translation>
    </message>
    <message>
        <source>Te&amp;xt size</source>
        <translation>S&amp;chriftgröße</translation>
    </message>
    <message>
        <source>&amp;Language</source>
        <translation>&amp;Sprache</translation>
    </message>
    <message>
        <source>Map &amp;tiles ...</source>
        <translation>Kar&amp;tenkacheln ...</translation>
    </message>
    <message>
        <source>Copy all &amp;messages</source>
        <translation>Alle Meldungen k&amp;opieren</translation>
    </message>
    <message>
        <source>&amp;Full screen</source>
        <translation>&amp;Vollbild</translation>
    </message>
    <message>
        <source>&amp;Shortcuts</source>
        <translation>&amp;Tastenkürzel</translation>
    </message>
    <message>
        <source>&amp;About Reflight</source>
        <translation>&amp;Über Reflight</translation>
    </message>
    <message>
        <source>none yet</source>
        <translation>noch keine</translation>
    </message>
    <message>
        <source>Shortcuts</source>
        <translation>Tastenkürzel</translation>
    </message>
    <message>
        <source>Reflight {0}: ground station for the second flight over a glass facade.</source>
        <translation>Reflight {0}: Bodenstation für den zweiten Flug über eine Glasfassade.</translation>
    </message>
    <message>
        <source>About Reflight</source>
        <translation>Über Reflight</translation>
    </message>
</context>
<context>
    <name>MessageArea</name>
    <message>
        <source>Messages</source>
        <translation>Meldungen</translation>
    </message>
    <message>
        <source>Show all messages</source>
        <translation>Alle Meldungen zeigen</translation>
    </message>
    <message>
        <source>Show place</source>
        <translation>Ort zeigen</translation>
    </message>
    <message>
        <source>Error</source>
        <translation>Fehler</translation>
    </message>
    <message>
        <source>Warning</source>
        <translation>Warnung</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Hinweis</translation>
    </message>
    <message>
        <source>Done</source>
        <translation>Fertig</translation>
    </message>
</context>
<context>
    <name>MissionDesk</name>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>{0} was read for a site that has changed; import again</source>
        <translation>{0} wurde für einen inzwischen geänderten Standort gelesen; neu importieren</translation>
    </message>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>{0} imported, photos: {1}, sorties: {2}</source>
        <translation>{0} importiert, Fotos: {1}, Einsätze: {2}</translation>
    </message>
    <message>
        <source>Import mission</source>
        <translation>Mission importieren</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Vergleichen</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>{0} more findings like these</source>
        <translation>{0} weitere solche Befunde</translation>
    </message>
</context>
<context>
    <name>MissionLists</name>
    <message>
        <source>Waypoints</source>
        <translation>Wegpunkte</translation>
    </message>
    <message>
        <source>Profile</source>
        <translation>Profil</translation>
    </message>
    <message>
        <source>Comparison</source>
        <translation>Vergleich</translation>
    </message>
</context>
<context>
    <name>MissionPage</name>
    <message>
        <source>Import the mission files of one flight</source>
        <translation>Missionsdateien eines Flugs importieren</translation>
    </message>
    <message>
        <source>Compare the plan with mission files</source>
        <translation>Plan mit Missionsdateien vergleichen</translation>
    </message>
    <message>
        <source>Missions ({0});;All files (*)</source>
        <translation>Missionen ({0});;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Export mission files ...</source>
        <translation>Missionsdateien exportieren ...</translation>
    </message>
    <message>
        <source>For DJI, QGroundControl, ...</source>
        <translation>Für DJI, QGroundControl, ...</translation>
    </message>
    <message>
        <source>Import mission files ...</source>
        <translation>Missionsdateien importieren ...</translation>
    </message>
    <message>
        <source>As a plan of this project</source>
        <translation>Als Plan dieses Projekts</translation>
    </message>
    <message>
        <source>Compare with file ...</source>
        <translation>Mit Datei vergleichen ...</translation>
    </message>
    <message>
        <source>Is this file the plan? Shows what differs</source>
        <translation>Ist diese Datei der Plan? Zeigt Abweichungen</translation>
    </message>
    <message>
        <source>Flight brief ...</source>
        <translation>Flugbriefing ...</translation>
    </message>
    <message>
        <source>To print or save as PDF</source>
        <translation>Drucken oder als PDF speichern</translation>
    </message>
    <message>
        <source>Check</source>
        <translation>Prüfen</translation>
    </message>
    <message>
        <source>Measure every pre-flight rule again</source>
        <translation>Jede Regel vor dem Flug neu messen</translation>
    </message>
    <message>
        <source>{0}, photos: {1}, batteries: {2}, {3}</source>
        <translation>{0}, Fotos: {1}, Akkus: {2}, {3}</translation>
    </message>
    <message>
        <source>No site</source>
        <translation>Kein Standort</translation>
    </message>
    <message>
        <source>Open or import a site first, on the Site tab.</source>
        <translation>Zuerst im Reiter Standort einen Standort öffnen oder importieren.</translation>
    </message>
    <message>
        <source>No plan</source>
        <translation>Kein Plan</translation>
    </message>
    <message>
        <source>Plan a flight on the Plan tab, or import a mission file.</source>
        <translation>Im Reiter Planung einen Flug planen oder eine Missionsdatei importieren.</translation>
    </message>
    <message>
        <source>{0} is not shown in the view</source>
        <translation>{0} ist in der Ansicht nicht dargestellt</translation>
    </message>
</context>
<context>
    <name>NoFlyPage</name>
    <message>
        <source>No-fly zone</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>From height</source>
        <translation>Ab Höhe</translation>
    </message>
    <message>
        <source>To height</source>
        <translation>Bis Höhe</translation>
    </message>
    <message>
        <source>Corners</source>
        <translation>Ecken</translation>
    </message>
    <message>
        <source>Change {0}</source>
        <translation>{0} ändern</translation>
    </message>
</context>
<context>
    <name>ObstaclePage</name>
    <message>
        <source>Obstacle</source>
        <translation>Hindernis</translation>
    </message>
    <message>
        <source>Mesh {0}
Size: {1}; triangles: {2}</source>
        <translation>Netz {0}
Größe: {1}; Dreiecke: {2}</translation>
    </message>
    <message>
        <source>Change {0}</source>
        <translation>{0} ändern</translation>
    </message>
</context>
<context>
    <name>OriginBox</name>
    <message>
        <source>North positive, WGS 84</source>
        <translation>Nord positiv, WGS 84</translation>
    </message>
    <message>
        <source>East positive, WGS 84</source>
        <translation>Ost positiv, WGS 84</translation>
    </message>
    <message>
        <source>Mean sea level by the EGM96 geoid, as autopilots and DJI use it; good to about a metre</source>
        <translation>Mittlerer Meeresspiegel nach dem Geoid EGM96, wie Autopiloten und DJI ihn nutzen; auf etwa einen Meter genau</translation>
    </message>
    <message>
        <source>Latitude</source>
        <translation>Breitengrad</translation>
    </message>
    <message>
        <source>Longitude</source>
        <translation>Längengrad</translation>
    </message>
    <message>
        <source>Height of the site&apos;s zero:</source>
        <translation>Höhe des Nullpunkts:</translation>
    </message>
    <message>
        <source>Above ellipsoid</source>
        <translation>Über Ellipsoid</translation>
    </message>
    <message>
        <source>Above sea level</source>
        <translation>Über Meer</translation>
    </message>
</context>
<context>
    <name>Overlay</name>
    <message>
        <source>N</source>
        <translation>N</translation>
    </message>
    <message>
        <source>{0:g} {1} in the middle</source>
        <translation>{0:g} {1} in Bildmitte</translation>
    </message>
    <message>
        <source>no value</source>
        <translation>kein Wert</translation>
    </message>
</context>
<context>
    <name>PaintBar</name>
    <message>
        <source>facade</source>
        <translation>Fassade</translation>
    </message>
    <message>
        <source>coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>hemispheres</source>
        <translation>Hemisphären</translation>
    </message>
    <message>
        <source>pixel size</source>
        <translation>Pixelgröße</translation>
    </message>
    <message>
        <source>sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>clearance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>Panels by</source>
        <translation>Scheiben nach</translation>
    </message>
    <message>
        <source>Route by</source>
        <translation>Route nach</translation>
    </message>
</context>
<context>
    <name>PanelDetail</name>
    <message>
        <source>Views of the section</source>
        <translation>Aufnahmen des Sektors</translation>
    </message>
    <message>
        <source>No panel selected</source>
        <translation>Keine Scheibe ausgewählt</translation>
    </message>
    <message>
        <source>Panel {0}</source>
        <translation>Scheibe {0}</translation>
    </message>
    <message>
        <source>What a plan covers of it stands here.</source>
        <translation>Hier steht, was ein Plan davon abdeckt.</translation>
    </message>
    <message>
        <source>{0} of {1} sections covered, {2} possible</source>
        <translation>{0} von {1} Sektoren abgedeckt, {2} erreichbar</translation>
    </message>
    <message>
        <source>; finest pixel {0}</source>
        <translation>; feinstes Pixel {0}</translation>
    </message>
    <message>
        <source>{0:g} to {1:g}° from the normal, {2:g} to {3:g}° around</source>
        <translation>{0:g} bis {1:g}° neben der Normalen, {2:g} bis {3:g}° um sie</translation>
    </message>
    <message>
        <source>covered; views that see it: {0}</source>
        <translation>abgedeckt; Aufnahmen davon: {0}</translation>
    </message>
    <message>
        <source>could be covered, but no view of this plan does</source>
        <translation>erreichbar, aber keine Aufnahme dieses Plans deckt ihn ab</translation>
    </message>
    <message>
        <source>cannot be covered from anywhere allowed</source>
        <translation>von keinem erlaubten Ort erreichbar</translation>
    </message>
    <message>
        <source>not covered; whether it could be is not known</source>
        <translation>nicht abgedeckt; ob erreichbar, ist unbekannt</translation>
    </message>
    <message>
        <source>Click a section to see its views.</source>
        <translation>Einen Sektor anklicken zeigt seine Aufnahmen.</translation>
    </message>
    <message>
        <source>; or </source>
        <translation>; oder </translation>
    </message>
</context>
<context>
    <name>PanelPage</name>
    <message>
        <source>Panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>On facade {0}
Size: {1} × {2}
Faces: {3}</source>
        <translation>An Fassade {0}
Größe: {1} × {2}
Blickrichtung: {3}</translation>
    </message>
    <message>
        <source>up</source>
        <translation>nach oben</translation>
    </message>
    <message>
        <source>down</source>
        <translation>nach unten</translation>
    </message>
    <message>
        <source>In the imported file: {0}</source>
        <translation>In der importierten Datei: {0}</translation>
    </message>
</context>
<context>
    <name>PhotoOverlay</name>
    <message>
        <source>horizon</source>
        <translation>Horizont</translation>
    </message>
</context>
<context>
    <name>PlanDesk</name>
    <message>
        <source>Only “Greedy with proof” can keep viewpoints. Choose it, or release those kept: {0}</source>
        <translation>Nur „Greedy mit Beweis“ kann Aufnahmepunkte fixieren. Diese Methode wählen oder die fixierten freigeben: {0}</translation>
    </message>
    <message>
        <source>{0}; release some, or ask for more views</source>
        <translation>{0}; einige freigeben oder mehr Aufnahmen verlangen</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Planen</translation>
    </message>
    <message>
        <source>It was not looked at. Choose it in the list of plans to do so.</source>
        <translation>Er wurde nicht ausgewertet. Dazu in der Liste der Pläne auswählen.</translation>
    </message>
    <message>
        <source>Rename plan</source>
        <translation>Plan umbenennen</translation>
    </message>
    <message>
        <source>Remove plan</source>
        <translation>Plan entfernen</translation>
    </message>
    <message>
        <source>Open plan</source>
        <translation>Plan öffnen</translation>
    </message>
    <message>
        <source>Keep {0}</source>
        <translation>{0} fixieren</translation>
    </message>
    <message>
        <source>Release {0}</source>
        <translation>{0} freigeben</translation>
    </message>
    <message>
        <source>Turn {0}</source>
        <translation>{0} drehen</translation>
    </message>
    <message>
        <source>Move {0}</source>
        <translation>{0} verschieben</translation>
    </message>
    <message>
        <source>Add {0}</source>
        <translation>{0} hinzufügen</translation>
    </message>
    <message>
        <source>Delete {0}</source>
        <translation>{0} löschen</translation>
    </message>
    <message>
        <source>Aim {0}</source>
        <translation>{0} ausrichten</translation>
    </message>
    <message>
        <source>{0}: sections gained {1}, lost {2}; flight time {3:+.0f} s</source>
        <translation>{0}: Sektoren gewonnen {1}, verloren {2}; Flugzeit {3:+.0f} s</translation>
    </message>
    <message>
        <source>{0} stays as it is: switch off “Keep when planning again” before you change it.</source>
        <translation>{0} bleibt, wie er ist: vor dem Ändern „Für Neuplanung fixieren“ ausschalten.</translation>
    </message>
    <message>
        <source>There is no plan to change; plan a flight or open a plan first.</source>
        <translation>Es gibt keinen Plan zum Ändern; zuerst einen Flug planen oder einen Plan öffnen.</translation>
    </message>
    <message>
        <source>The plan is still being looked at; try again in a moment.</source>
        <translation>Der Plan wird noch ausgewertet; gleich noch einmal versuchen.</translation>
    </message>
    <message>
        <source>The plan is not kept: it was made for “{0}”, which is no longer open.</source>
        <translation>Der Plan wird verworfen: Er gilt für „{0}“, das nicht mehr offen ist.</translation>
    </message>
    <message>
        <source>{0}, {1} views</source>
        <translation>{0}, Aufnahmen: {1}</translation>
    </message>
    <message>
        <source>Views: {0}, sorties: {1}; covered {2} of at most {3} sections</source>
        <translation>Aufnahmen: {0}, Einsätze: {1}; abgedeckt {2} von höchstens {3} Sektoren</translation>
    </message>
    <message>
        <source>Look at the plan</source>
        <translation>Plan auswerten</translation>
    </message>
</context>
<context>
    <name>PlanForm</name>
    <message>
        <source>More settings</source>
        <translation>Mehr Einstellungen</translation>
    </message>
    <message>
        <source>coverage wanted</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>number of views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>batteries at hand</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>Limit the pixel size</source>
        <translation>Pixelgröße begrenzen</translation>
    </message>
    <message>
        <source>Count whole panels only</source>
        <translation>Nur ganze Scheiben zählen</translation>
    </message>
    <message>
        <source>A view counts only when all four corners are in the picture</source>
        <translation>Eine Aufnahme zählt nur, wenn alle vier Ecken im Bild sind</translation>
    </message>
    <message>
        <source>Weight sections by solid angle</source>
        <translation>Sektoren nach Raumwinkel</translation>
    </message>
    <message>
        <source>single (fast)</source>
        <translation>einfach (schnell)</translation>
    </message>
    <message>
        <source>double (slower)</source>
        <translation>doppelt (langsamer)</translation>
    </message>
    <message>
        <source>Greedy with proof</source>
        <translation>Greedy mit Beweis</translation>
    </message>
    <message>
        <source>Particle swarm (paper)</source>
        <translation>Schwarm (Paper)</translation>
    </message>
    <message>
        <source>Nap-of-the-object grid</source>
        <translation>Konturraster</translation>
    </message>
    <message>
        <source>Orbits</source>
        <translation>Umkreisungen</translation>
    </message>
    <message>
        <source>Aircraft</source>
        <translation>Fluggerät</translation>
    </message>
    <message>
        <source>Plan for</source>
        <translation>Ziel</translation>
    </message>
    <message>
        <source>Coverage</source>
        <translation>Abdeckung</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Batteries</source>
        <translation>Akkus</translation>
    </message>
    <message>
        <source>Safety distance</source>
        <translation>Mindestabstand</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Time to plan</source>
        <translation>Planungszeit</translation>
    </message>
    <message>
        <source>Wind</source>
        <translation>Wind</translation>
    </message>
    <message>
        <source>Battery reserve</source>
        <translation>Akkureserve</translation>
    </message>
    <message>
        <source>Hover before photo</source>
        <translation>Halt vor Foto</translation>
    </message>
    <message>
        <source>Coarsest pixel</source>
        <translation>Gröbstes Pixel</translation>
    </message>
    <message>
        <source>Section step</source>
        <translation>Sektorweite</translation>
    </message>
    <message>
        <source>Precision</source>
        <translation>Genauigkeit</translation>
    </message>
    <message>
        <source>Seed</source>
        <translation>Startwert</translation>
    </message>
    <message>
        <source>Pixels of {0} need views within {1}, but the safety distance is {2}: allow coarser pixels, or come nearer.</source>
        <translation>Pixel von {0} brauchen Aufnahmen aus höchstens {1}, der Mindestabstand ist aber {2}: gröbere Pixel zulassen oder näher heran.</translation>
    </message>
</context>
<context>
    <name>PlanLists</name>
    <message>
        <source>Viewpoints</source>
        <translation>Punkte</translation>
    </message>
    <message>
        <source>Not covered</source>
        <translation>Lücken</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Abstand</translation>
    </message>
    <message>
        <source>Plans</source>
        <translation>Pläne</translation>
    </message>
    <message>
        <source>Plan a flight, and what it does not cover stands here.</source>
        <translation>Einen Flug planen; dann steht hier, was er nicht abdeckt.</translation>
    </message>
    <message>
        <source>{0} sections could still be covered, {1} cannot be covered from anywhere allowed</source>
        <translation>{0} Sektoren wären noch erreichbar, {1} sind von keinem erlaubten Ort erreichbar</translation>
    </message>
    <message>
        <source>more views would cover them</source>
        <translation>mehr Aufnahmen würden sie abdecken</translation>
    </message>
    <message>
        <source>not known whether anything could</source>
        <translation>unbekannt, ob erreichbar</translation>
    </message>
    <message>
        <source>not known why</source>
        <translation>Grund unbekannt</translation>
    </message>
    <message>
        <source> and </source>
        <translation> und </translation>
    </message>
    <message>
        <source>the gimbal cannot look up so far</source>
        <translation>der Gimbal kann nicht so weit nach oben</translation>
    </message>
    <message>
        <source>the gimbal cannot look down so far</source>
        <translation>der Gimbal kann nicht so weit nach unten</translation>
    </message>
    <message>
        <source>below the airspace</source>
        <translation>unter dem Luftraum</translation>
    </message>
    <message>
        <source>above the airspace</source>
        <translation>über dem Luftraum</translation>
    </message>
    <message>
        <source>beyond the sides of the airspace</source>
        <translation>seitlich außerhalb des Luftraums</translation>
    </message>
    <message>
        <source>too far away for the pixel size wanted</source>
        <translation>zu weit weg für die gewünschte Pixelgröße</translation>
    </message>
    <message>
        <source>too close to building or obstacle</source>
        <translation>zu nah an Gebäude oder Hindernis</translation>
    </message>
    <message>
        <source>in a no-fly volume</source>
        <translation>in einer Flugverbotszone</translation>
    </message>
    <message>
        <source>below the ground</source>
        <translation>unter dem Boden</translation>
    </message>
    <message>
        <source>hidden by something</source>
        <translation>verdeckt</translation>
    </message>
    <message>
        <source>cannot be flown to</source>
        <translation>nicht anfliegbar</translation>
    </message>
    <message>
        <source>Measure clearance</source>
        <translation>Abstand messen</translation>
    </message>
    <message>
        <source>Open plan</source>
        <translation>Plan öffnen</translation>
    </message>
    <message>
        <source>Plans (*.json)</source>
        <translation>Pläne (*.json)</translation>
    </message>
    <message>
        <source>Select two or more plans in the list of plans to compare.</source>
        <translation>Zum Vergleichen zwei oder mehr Pläne in der Liste auswählen.</translation>
    </message>
</context>
<context>
    <name>PlanPage</name>
    <message>
        <source>Plan</source>
        <translation>Planen</translation>
    </message>
    <message>
        <source>Plan the flight</source>
        <translation>Den Flug planen</translation>
    </message>
    <message>
        <source>Good enough, stop here</source>
        <translation>Gut genug, hier beenden</translation>
    </message>
    <message>
        <source>Compare plans</source>
        <translation>Pläne vergleichen</translation>
    </message>
    <message>
        <source>Quality</source>
        <translation>Güte</translation>
    </message>
    <message>
        <source>Effects</source>
        <translation>Effekte</translation>
    </message>
    <message>
        <source>Panel</source>
        <translation>Scheibe</translation>
    </message>
    <message>
        <source>View</source>
        <translation>Punkt</translation>
    </message>
    <message>
        <source>Open or import a site first, on the Site tab.</source>
        <translation>Zuerst im Reiter Standort einen Standort öffnen oder importieren.</translation>
    </message>
    <message>
        <source>Planning ...</source>
        <translation>Planung läuft ...</translation>
    </message>
    <message>
        <source>No plan yet.</source>
        <translation>Noch kein Plan.</translation>
    </message>
    <message>
        <source>This plan cannot be judged. {0}</source>
        <translation>Dieser Plan lässt sich nicht beurteilen. {0}</translation>
    </message>
    <message>
        <source>The plan is being looked at ...</source>
        <translation>Der Plan wird ausgewertet ...</translation>
    </message>
    <message>
        <source>Ready to fly; warnings: {0}</source>
        <translation>Flugbereit; Warnungen: {0}</translation>
    </message>
    <message>
        <source>NOT ready to fly; errors: {0}. {1}</source>
        <translation>NICHT flugbereit; Fehler: {0}. {1}</translation>
    </message>
    <message>
        <source>Views: {0}, sorties: {1}</source>
        <translation>Aufnahmen: {0}, Einsätze: {1}</translation>
    </message>
    <message>
        <source>{0} of {1} sections covered ({2:.1f} % of the {3} that any flight could cover)</source>
        <translation>{0} von {1} Sektoren abgedeckt ({2:.1f} % der {3} überhaupt erreichbaren)</translation>
    </message>
    <message>
        <source>Time in the air {0}, way flown {1}</source>
        <translation>Flugzeit {0}, Flugweg {1}</translation>
    </message>
    <message>
        <source>smallest clearance {0}</source>
        <translation>kleinster Abstand {0}</translation>
    </message>
    <message>
        <source>pixels from {0}</source>
        <translation>Pixel ab {0}</translation>
    </message>
</context>
<context>
    <name>PlanPictures</name>
    <message>
        <source>Covered of what is possible</source>
        <translation>Abgedeckt vom Erreichbaren</translation>
    </message>
    <message>
        <source>Finest pixel</source>
        <translation>Feinstes Pixel</translation>
    </message>
    <message>
        <source>Clearance</source>
        <translation>Abstand</translation>
    </message>
</context>
<context>
    <name>PlansList</name>
    <message>
        <source>Plans</source>
        <translation>Pläne</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Vergleichen</translation>
    </message>
    <message>
        <source>Show the selected plans side by side (two or more)</source>
        <translation>Ausgewählte Pläne nebeneinander zeigen (zwei oder mehr)</translation>
    </message>
    <message>
        <source>Rename ...</source>
        <translation>Umbenennen ...</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Open plan ...</source>
        <translation>Plan öffnen ...</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Plan</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Verfahren</translation>
    </message>
    <message>
        <source>Views</source>
        <translation>Aufnahmen</translation>
    </message>
    <message>
        <source>Covered</source>
        <translation>Abgedeckt</translation>
    </message>
    <message>
        <source>of at most</source>
        <translation>von höchstens</translation>
    </message>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>Duration</source>
        <translation>Dauer</translation>
    </message>
    <message>
        <source>Length</source>
        <translation>Flugweg</translation>
    </message>
    <message>
        <source>Rename plan</source>
        <translation>Plan umbenennen</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
</context>
<context>
    <name>PolygonBox</name>
    <message>
        <source>Add a corner after this one</source>
        <translation>Ecke nach dieser hinzufügen</translation>
    </message>
    <message>
        <source>Remove this corner</source>
        <translation>Diese Ecke entfernen</translation>
    </message>
</context>
<context>
    <name>ProfileChart</name>
    <message>
        <source>over time</source>
        <translation>über der Zeit</translation>
    </message>
    <message>
        <source>over distance</source>
        <translation>über dem Flugweg</translation>
    </message>
    <message>
        <source>Height and speed</source>
        <translation>Höhe und Geschwindigkeit</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>Height [{0}]</source>
        <translation>Höhe [{0}]</translation>
    </message>
    <message>
        <source>Speed [{0}]</source>
        <translation>Tempo [{0}]</translation>
    </message>
    <message>
        <source>Time [min]</source>
        <translation>Zeit [min]</translation>
    </message>
    <message>
        <source>Distance [{0}]</source>
        <translation>Flugweg [{0}]</translation>
    </message>
    <message>
        <source>No sortie to show: plan a flight first.</source>
        <translation>Kein Einsatz zu zeigen: zuerst einen Flug planen.</translation>
    </message>
    <message>
        <source>ground</source>
        <translation>Boden</translation>
    </message>
    <message>
        <source>airspace floor</source>
        <translation>Luftraum unten</translation>
    </message>
    <message>
        <source>airspace ceiling</source>
        <translation>Luftraum oben</translation>
    </message>
    <message>
        <source>legal ceiling</source>
        <translation>gesetzliche Höhengrenze</translation>
    </message>
    <message>
        <source>{0} {1}</source>
        <translation>{0} {1}</translation>
    </message>
    <message>
        <source>{0} min, {1} flown: {2} above take-off, {3}, nearest photo {4}</source>
        <translation>{0} min, {1} geflogen: {2} über Start, {3}, nächstes Foto {4}</translation>
    </message>
</context>
<context>
    <name>QualityChart</name>
    <message>
        <source>Good enough, stop here</source>
        <translation>Gut genug, hier beenden</translation>
    </message>
    <message>
        <source>Keep the best views found so far and plan the route</source>
        <translation>Die besten bisher gefundenen Aufnahmen behalten und die Route planen</translation>
    </message>
    <message>
        <source>covered sections</source>
        <translation>abgedeckte Sektoren</translation>
    </message>
    <message>
        <source>time in s</source>
        <translation>Zeit in s</translation>
    </message>
    <message>
        <source>Quality against time appears here while a plan runs.</source>
        <translation>Während der Planung erscheint hier Güte über der Zeit.</translation>
    </message>
    <message>
        <source>The search found {0:.0f} sections, {1:.1f} % of the {2:.0f} that any flight could cover</source>
        <translation>Die Suche fand {0:.0f} Sektoren, {1:.1f} % der {2:.0f} überhaupt erreichbaren</translation>
    </message>
    <message>
        <source>{0:.0f} sections covered, {1:.1f} % of the {2:.0f} that any flight could cover</source>
        <translation>{0:.0f} Sektoren abgedeckt, {1:.1f} % der {2:.0f} überhaupt erreichbaren</translation>
    </message>
    <message>
        <source>{0:.0f} sections covered</source>
        <translation>{0:.0f} Sektoren abgedeckt</translation>
    </message>
    <message>
        <source>{0:.0f} s, at most {1:.0f} s left</source>
        <translation>{0:.0f} s, noch höchstens {1:.0f} s</translation>
    </message>
</context>
<context>
    <name>Questions</name>
    <message>
        <source>Unsaved changes</source>
        <translation>Ungesicherte Änderungen</translation>
    </message>
    <message>
        <source>This project has changes that are not saved. Save them first?</source>
        <translation>Dieses Projekt hat ungesicherte Änderungen. Zuerst speichern?</translation>
    </message>
    <message>
        <source>Reflight ended before this work was saved (copy of {0}):
{1}

Take it over?</source>
        <translation>Reflight endete, bevor diese Arbeit gespeichert war (Kopie von {0}):
{1}

Übernehmen?</translation>
    </message>
    <message>
        <source>The project was saved by others since then: their changes would be taken back.</source>
        <translation>Das Projekt wurde seither von anderen gespeichert: Deren Änderungen gingen verloren.</translation>
    </message>
    <message>
        <source>Unsaved work</source>
        <translation>Ungesicherte Arbeit</translation>
    </message>
</context>
<context>
    <name>ReachTable</name>
    <message>
        <source>Why not</source>
        <translation>Warum nicht</translation>
    </message>
    <message>
        <source>Sections</source>
        <translation>Sektoren</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>What lacks least</source>
        <translation>Am wenigsten fehlt</translation>
    </message>
    <message>
        <source>Sections that are not covered</source>
        <translation>Nicht abgedeckte Sektoren</translation>
    </message>
</context>
<context>
    <name>SceneTexts</name>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Building</source>
        <translation>Gebäude</translation>
    </message>
    <message>
        <source>Sortie {0}, leg {1}</source>
        <translation>Einsatz {0}, Strecke {1}</translation>
    </message>
    <message>
        <source>Panel {0}</source>
        <translation>Scheibe {0}</translation>
    </message>
    <message>
        <source>Viewpoint {0}</source>
        <translation>Aufnahmepunkt {0}</translation>
    </message>
    <message>
        <source>covered; darker: by more views</source>
        <translation>abgedeckt; dunkler: von mehr Aufnahmen</translation>
    </message>
    <message>
        <source>open: could be covered</source>
        <translation>offen: erreichbar</translation>
    </message>
    <message>
        <source>unreachable</source>
        <translation>unerreichbar</translation>
    </message>
    <message>
        <source>undecided</source>
        <translation>unentschieden</translation>
    </message>
    <message>
        <source>Start and landing {0}</source>
        <translation>Start und Landung {0}</translation>
    </message>
    <message>
        <source>Start {0}, landing {1}</source>
        <translation>Start {0}, Landung {1}</translation>
    </message>
    <message>
        <source>Start {0}</source>
        <translation>Start {0}</translation>
    </message>
    <message>
        <source>Landing {0}</source>
        <translation>Landung {0}</translation>
    </message>
</context>
<context>
    <name>SiteDetail</name>
    <message>
        <source>What is selected on the site is shown here.</source>
        <translation>Hier erscheint, was am Standort ausgewählt ist.</translation>
    </message>
</context>
<context>
    <name>SiteEditor</name>
    <message>
        <source>Remove {0}</source>
        <translation>{0} entfernen</translation>
    </message>
    <message>
        <source>Turn facade {0}</source>
        <translation>Fassade {0} drehen</translation>
    </message>
    <message>
        <source>Check the site</source>
        <translation>Standort prüfen</translation>
    </message>
</context>
<context>
    <name>SiteOpener</name>
    <message>
        <source>Open site</source>
        <translation>Standort öffnen</translation>
    </message>
    <message>
        <source>Sites (*.json);;All files (*)</source>
        <translation>Standorte (*.json);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Import a building model</source>
        <translation>Gebäudemodell importieren</translation>
    </message>
    <message>
        <source>Building models ({0});;All files (*)</source>
        <translation>Gebäudemodelle ({0});;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Open {0}</source>
        <translation>{0} öffnen</translation>
    </message>
    <message>
        <source>Import {0}</source>
        <translation>{0} importieren</translation>
    </message>
    <message>
        <source>Office: one flat facade of 280 panels</source>
        <translation>Büro: eine ebene Fassade mit 280 Scheiben</translation>
    </message>
    <message>
        <source>Library: one curved facade of 300 panels</source>
        <translation>Bibliothek: eine gekrümmte Fassade mit 300 Scheiben</translation>
    </message>
    <message>
        <source>Court: two wings that hide each other</source>
        <translation>Hof: zwei Flügel, die einander verdecken</translation>
    </message>
    <message>
        <source>Canyon: a facade on a narrow street</source>
        <translation>Schlucht: eine Fassade an enger Straße</translation>
    </message>
    <message>
        <source>Roof: horizontal skylights</source>
        <translation>Dach: waagerechte Oberlichter</translation>
    </message>
    <message>
        <source>Tower: 3 640 panels on four sides</source>
        <translation>Turm: 3 640 Scheiben an vier Seiten</translation>
    </message>
    <message>
        <source>A single panel</source>
        <translation>Eine einzelne Scheibe</translation>
    </message>
    <message>
        <source>{0}: panels {1}, facades {2}</source>
        <translation>{0}: Scheiben {1}, Fassaden {2}</translation>
    </message>
    <message>
        <source>The plans of the site before are put away with it: {0}. Undo brings them back.</source>
        <translation>Die Pläne des vorigen Standorts verschwinden mit ihm: {0}. „Rückgängig“ holt sie zurück.</translation>
    </message>
</context>
<context>
    <name>SitePage</name>
    <message>
        <source>Name of the site</source>
        <translation>Name des Standorts</translation>
    </message>
    <message>
        <source>Place of the site&apos;s zero</source>
        <translation>Lage des Nullpunkts</translation>
    </message>
    <message>
        <source>Rename site</source>
        <translation>Standort umbenennen</translation>
    </message>
    <message>
        <source>Set origin</source>
        <translation>Nullpunkt setzen</translation>
    </message>
</context>
<context>
    <name>SiteSide</name>
    <message>
        <source>Import...</source>
        <translation>Import...</translation>
    </message>
    <message>
        <source>Open...</source>
        <translation>Öffnen...</translation>
    </message>
    <message>
        <source>Bundled site</source>
        <translation>Beispiel</translation>
    </message>
    <message>
        <source>Open site...</source>
        <translation>Standort öffnen...</translation>
    </message>
    <message>
        <source>Import building model...</source>
        <translation>Gebäudemodell importieren...</translation>
    </message>
    <message>
        <source>Remove what is selected</source>
        <translation>Auswahl entfernen</translation>
    </message>
</context>
<context>
    <name>SiteSummary</name>
    <message>
        <source>Panels: {0} on {1} facades, {2} of glass
Size: {3}; triangles: {4}</source>
        <translation>Scheiben: {0}, Fassaden: {1}, Glas: {2}
Größe: {3}; Dreiecke: {4}</translation>
    </message>
</context>
<context>
    <name>SiteTools</name>
    <message>
        <source>Obstacle mesh...</source>
        <translation>Hindernisnetz...</translation>
    </message>
    <message>
        <source>Add an obstacle from a mesh file in the site&apos;s coordinates (a crane, a tree)</source>
        <translation>Hindernis aus einer Netzdatei in Koordinaten des Standorts hinzufügen (Kran, Baum)</translation>
    </message>
    <message>
        <source>Panel grid</source>
        <translation>Scheibenraster</translation>
    </message>
    <message>
        <source>Equal panels in a rectangle on a wall</source>
        <translation>Gleiche Scheiben in einem Rechteck an einer Wand</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
    <message>
        <source>Click where the aircraft takes off and lands</source>
        <translation>Klicken, wo das Fluggerät startet und landet</translation>
    </message>
    <message>
        <source>No-fly zone</source>
        <translation>Flugverbotszone</translation>
    </message>
    <message>
        <source>Draw a zone that must not be entered on the ground</source>
        <translation>Auf dem Boden eine Zone zeichnen, in die nicht geflogen werden darf</translation>
    </message>
    <message>
        <source>Obstacle box</source>
        <translation>Hindernisquader</translation>
    </message>
    <message>
        <source>Draw a box: two corners on the ground, then the height</source>
        <translation>Quader zeichnen: zwei Ecken am Boden, dann die Höhe</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Draw the box in which the aircraft must stay</source>
        <translation>Den Quader zeichnen, in dem das Fluggerät bleiben muss</translation>
    </message>
    <message>
        <source>Add obstacle {0}</source>
        <translation>Hindernis {0} hinzufügen</translation>
    </message>
    <message>
        <source>Read {0}</source>
        <translation>{0} lesen</translation>
    </message>
    <message>
        <source>Draw no-fly zone</source>
        <translation>Flugverbotszone zeichnen</translation>
    </message>
    <message>
        <source>Draw obstacle</source>
        <translation>Hindernis zeichnen</translation>
    </message>
    <message>
        <source>Draw airspace</source>
        <translation>Luftraum zeichnen</translation>
    </message>
    <message>
        <source>Move home</source>
        <translation>Startplatz versetzen</translation>
    </message>
    <message>
        <source>Obstacle mesh</source>
        <translation>Hindernisnetz</translation>
    </message>
    <message>
        <source>Meshes ({0})</source>
        <translation>Netze ({0})</translation>
    </message>
</context>
<context>
    <name>SiteTree</name>
    <message>
        <source>Show it</source>
        <translation>Zeigen</translation>
    </message>
    <message>
        <source>Rename</source>
        <translation>Umbenennen</translation>
    </message>
    <message>
        <source>Turn to the other side</source>
        <translation>Auf die andere Seite drehen</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
</context>
<context>
    <name>SiteTreeModel</name>
    <message>
        <source>On the site</source>
        <translation>Am Standort</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>panels: {0}</source>
        <translation>Scheiben: {0}</translation>
    </message>
    <message>
        <source>Facades</source>
        <translation>Fassaden</translation>
    </message>
    <message>
        <source>Obstacles</source>
        <translation>Hindernisse</translation>
    </message>
    <message>
        <source>No-fly zones</source>
        <translation>Flugverbotszonen</translation>
    </message>
    <message>
        <source>Airspace</source>
        <translation>Luftraum</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Startplatz</translation>
    </message>
</context>
<context>
    <name>SortieTable</name>
    <message>
        <source>Sorties</source>
        <translation>Einsätze</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>Nr.</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>Used</source>
        <translation>Akku</translation>
    </message>
    <message>
        <source>Part of the battery&apos;s endurance that the sortie takes</source>
        <translation>Anteil der Flugzeit eines Akkus, den der Einsatz braucht</translation>
    </message>
    <message>
        <source>Length of the flight</source>
        <translation>Länge des Flugwegs</translation>
    </message>
</context>
<context>
    <name>Stage</name>
    <message>
        <source>The 3-D view is being prepared ...</source>
        <translation>Die 3D-Ansicht wird vorbereitet ...</translation>
    </message>
    <message>
        <source>3-D</source>
        <translation>3D</translation>
    </message>
    <message>
        <source>The site in three dimensions</source>
        <translation>Der Standort in drei Dimensionen</translation>
    </message>
    <message>
        <source>Map</source>
        <translation>Karte</translation>
    </message>
    <message>
        <source>The site from above, on the map</source>
        <translation>Der Standort von oben, auf der Karte</translation>
    </message>
    <message>
        <source>Camera</source>
        <translation>Kamera</translation>
    </message>
    <message>
        <source>What a viewpoint will see</source>
        <translation>Was ein Aufnahmepunkt sehen wird</translation>
    </message>
</context>
<context>
    <name>StartPage</name>
    <message>
        <source>Begin with a site</source>
        <translation>Mit einem Standort beginnen</translation>
    </message>
    <message>
        <source>A site holds the glass panels, the building, and where you may fly.</source>
        <translation>Ein Standort enthält die Glasscheiben, das Gebäude und den erlaubten Flugraum.</translation>
    </message>
    <message>
        <source>Import a building model</source>
        <translation>Gebäudemodell importieren</translation>
    </message>
    <message>
        <source>Open a site file</source>
        <translation>Standortdatei öffnen</translation>
    </message>
    <message>
        <source>Try a bundled site</source>
        <translation>Beispielstandort ansehen</translation>
    </message>
    <message>
        <source>IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL</source>
        <translation>IFC, CityGML, CityJSON, OBJ, PLY, GLB oder STL</translation>
    </message>
    <message>
        <source>A site.json, from here or from the command line</source>
        <translation>Eine site.json, von hier oder von der Kommandozeile</translation>
    </message>
    <message>
        <source>To look around, and to try a plan</source>
        <translation>Zum Umsehen und Probeplanen</translation>
    </message>
</context>
<context>
    <name>Tabs</name>
    <message>
        <source>Flying from this window is not built yet.</source>
        <translation>Fliegen aus diesem Fenster gibt es noch nicht.</translation>
    </message>
    <message>
        <source>Export the mission on the Mission tab and fly it with DJI Pilot 2, QGroundControl or Mission Planner.</source>
        <translation>Die Mission im Reiter Mission exportieren und mit DJI Pilot 2, QGroundControl oder Mission Planner fliegen.</translation>
    </message>
    <message>
        <source>Fly</source>
        <translation>Fliegen</translation>
    </message>
    <message>
        <source>Upload, rehearse and watch the flight</source>
        <translation>Flug hochladen, proben und überwachen</translation>
    </message>
    <message>
        <source>Mission</source>
        <translation>Mission</translation>
    </message>
    <message>
        <source>Waypoints, checks, mission files and the flight brief</source>
        <translation>Wegpunkte, Prüfungen, Missionsdateien und Flugbriefing</translation>
    </message>
    <message>
        <source>Viewing models in this window is not built yet.</source>
        <translation>Modelle ansehen gibt es in diesem Fenster noch nicht.</translation>
    </message>
    <message>
        <source>Panels of the site can be looked at on the Site tab.</source>
        <translation>Die Scheiben des Standorts sind im Reiter Standort zu sehen.</translation>
    </message>
    <message>
        <source>Model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>Look at the model and the record of each panel</source>
        <translation>Modell und Akte jeder Scheibe ansehen</translation>
    </message>
    <message>
        <source>Reading photos in this window is not built yet.</source>
        <translation>Fotos lesen gibt es in diesem Fenster noch nicht.</translation>
    </message>
    <message>
        <source>Keep the photos of each flight in the project&apos;s folder &apos;photos&apos;; they will be read from there.</source>
        <translation>Die Fotos jedes Flugs im Projektordner „photos“ ablegen; von dort werden sie gelesen.</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotos</translation>
    </message>
    <message>
        <source>Read the photos and find the glass panels</source>
        <translation>Fotos lesen und Glasscheiben finden</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Planung</translation>
    </message>
    <message>
        <source>Choose viewpoints and routes</source>
        <translation>Aufnahmepunkte und Routen wählen</translation>
    </message>
    <message>
        <source>Reconstruction in this window is not built yet.</source>
        <translation>Rekonstruktion gibt es in diesem Fenster noch nicht.</translation>
    </message>
    <message>
        <source>Any photogrammetry program takes the photos of the second flight; their positions are in the EXIF data.</source>
        <translation>Jedes Photogrammetrieprogramm nimmt die Fotos des zweiten Flugs; ihre Positionen stehen in den EXIF-Daten.</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Rekonstruktion</translation>
    </message>
    <message>
        <source>Turn the photos into a model</source>
        <translation>Aus den Fotos ein Modell machen</translation>
    </message>
    <message>
        <source>Site</source>
        <translation>Standort</translation>
    </message>
    <message>
        <source>The building, its glass, and where you may fly</source>
        <translation>Das Gebäude, sein Glas und der erlaubte Flugraum</translation>
    </message>
</context>
<context>
    <name>ToolDriver</name>
    <message>
        <source>Click a point. Esc cancels.</source>
        <translation>Einen Punkt anklicken. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click the lower left corner, as seen from outside. Esc cancels.</source>
        <translation>Die untere linke Ecke anklicken, von außen gesehen. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click the lower right corner. Shift keeps a slope, Backspace goes back.</source>
        <translation>Die untere rechte Ecke anklicken. Umschalt behält ein Gefälle, Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Click the upper edge. Backspace goes back, Esc cancels.</source>
        <translation>Die Oberkante anklicken. Rücktaste geht zurück, Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click a corner on the ground. Esc cancels.</source>
        <translation>Eine Ecke am Boden anklicken. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Click more corners; Enter, a double click or the first corner ends.</source>
        <translation>Weitere Ecken anklicken; Eingabe, Doppelklick oder die erste Ecke beendet.</translation>
    </message>
    <message>
        <source>This side would cross another: click elsewhere, or Backspace to go back.</source>
        <translation>Diese Seite würde eine andere kreuzen: woanders klicken oder mit Rücktaste zurück.</translation>
    </message>
    <message>
        <source>Click the opposite corner. Backspace goes back.</source>
        <translation>Die gegenüberliegende Ecke anklicken. Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Move up to the height and click. Backspace goes back.</source>
        <translation>Bis zur Höhe hochziehen und klicken. Rücktaste geht zurück.</translation>
    </message>
    <message>
        <source>Click where the aircraft takes off and lands. Esc cancels.</source>
        <translation>Klicken, wo das Fluggerät startet und landet. Esc bricht ab.</translation>
    </message>
    <message>
        <source>Drag the viewpoint; Shift moves it along its line of sight. Arrow and Page keys move it by 1 m, with Shift by 0.1 m. Esc ends.</source>
        <translation>Aufnahmepunkt ziehen; Umschalt bewegt ihn längs der Blickrichtung. Pfeil- und Bildtasten bewegen ihn um 1 m, mit Umschalt um 0.1 m. Esc beendet.</translation>
    </message>
    <message>
        <source>There is nothing at this place. Click on the building or on the ground.</source>
        <translation>An dieser Stelle ist nichts. Auf das Gebäude oder den Boden klicken.</translation>
    </message>
    <message>
        <source> x </source>
        <translation> x </translation>
    </message>
</context>
<context>
    <name>ViewpointEditor</name>
    <message>
        <source>Keep when planning again</source>
        <translation>Für Neuplanung fixieren</translation>
    </message>
    <message>
        <source>Keep this viewpoint as it is when planning again</source>
        <translation>Diesen Aufnahmepunkt beim Neuplanen unverändert lassen</translation>
    </message>
    <message>
        <source>Add</source>
        <translation>Neu</translation>
    </message>
    <message>
        <source>A new viewpoint beside this one</source>
        <translation>Ein neuer Aufnahmepunkt neben diesem</translation>
    </message>
    <message>
        <source>Delete</source>
        <translation>Löschen</translation>
    </message>
    <message>
        <source>Aim at panel</source>
        <translation>Ausrichten</translation>
    </message>
    <message>
        <source>Turn towards the panel that was selected last</source>
        <translation>Zur zuletzt ausgewählten Scheibe drehen</translation>
    </message>
    <message>
        <source>East</source>
        <translation>Ost</translation>
    </message>
    <message>
        <source>North</source>
        <translation>Nord</translation>
    </message>
    <message>
        <source>Up</source>
        <translation>Höhe</translation>
    </message>
    <message>
        <source>Heading</source>
        <translation>Richtung</translation>
    </message>
    <message>
        <source>Pitch</source>
        <translation>Gimbalneigung</translation>
    </message>
    <message>
        <source>No viewpoint selected</source>
        <translation>Kein Aufnahmepunkt ausgewählt</translation>
    </message>
</context>
<context>
    <name>ViewpointPage</name>
    <message>
        <source>Move in the 3-D view</source>
        <translation>In der 3D-Ansicht verschieben</translation>
    </message>
    <message>
        <source>Drag the selected viewpoint; with Shift along its line of sight; or arrow keys</source>
        <translation>Gewählten Aufnahmepunkt ziehen; mit Umschalt längs der Blickrichtung; oder Pfeiltasten</translation>
    </message>
    <message>
        <source>Add viewpoint</source>
        <translation>Aufnahmepunkt hinzufügen</translation>
    </message>
    <message>
        <source>Delete viewpoint</source>
        <translation>Aufnahmepunkt löschen</translation>
    </message>
    <message>
        <source>Keep viewpoint when planning again</source>
        <translation>Aufnahmepunkt für Neuplanung fixieren</translation>
    </message>
    <message>
        <source>Move viewpoint in the 3-D view</source>
        <translation>Aufnahmepunkt in der 3D-Ansicht verschieben</translation>
    </message>
    <message>
        <source>Covers {0} panels, {1} sections that no other view covers. The plan covers {2}.</source>
        <translation>Deckt {0} Scheiben ab und {1} Sektoren, die keine andere Aufnahme abdeckt. Der Plan deckt {2} ab.</translation>
    </message>
    <message>
        <source>Click a panel first, then the viewpoint, then Aim.</source>
        <translation>Erst eine Scheibe anklicken, dann den Aufnahmepunkt, dann „Ausrichten“.</translation>
    </message>
</context>
<context>
    <name>WaypointModel</name>
    <message>
        <source>The path turns here; no photo is taken.</source>
        <translation>Hier knickt der Flugweg; kein Foto.</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keiner</translation>
    </message>
    <message>
        <source>locked</source>
        <translation>fixiert</translation>
    </message>
    <message>
        <source>Sortie</source>
        <translation>Einsatz</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>Nr.</translation>
    </message>
    <message>
        <source>Viewpoint</source>
        <translation>Aufnahmepunkt</translation>
    </message>
    <message>
        <source>East [{0}]</source>
        <translation>Ost [{0}]</translation>
    </message>
    <message>
        <source>Latitude [°]</source>
        <translation>Breitengrad [°]</translation>
    </message>
    <message>
        <source>North [{0}]</source>
        <translation>Nord [{0}]</translation>
    </message>
    <message>
        <source>Longitude [°]</source>
        <translation>Längengrad [°]</translation>
    </message>
    <message>
        <source>Above take-off [{0}]</source>
        <translation>Über Start [{0}]</translation>
    </message>
    <message>
        <source>Heading [°]</source>
        <translation>Richtung [°]</translation>
    </message>
    <message>
        <source>Gimbal [°]</source>
        <translation>Gimbal [°]</translation>
    </message>
    <message>
        <source>Leg [{0}]</source>
        <translation>Strecke [{0}]</translation>
    </message>
    <message>
        <source>Arrival</source>
        <translation>Ankunft</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Scheiben</translation>
    </message>
    <message>
        <source>Locked</source>
        <translation>Fixiert</translation>
    </message>
    <message>
        <source>Up, local [{0}]</source>
        <translation>Höhe, lokal [{0}]</translation>
    </message>
    <message>
        <source>Above sea (EGM96) [{0}]</source>
        <translation>Über Meer (EGM96) [{0}]</translation>
    </message>
    <message>
        <source>Above ellipsoid [{0}]</source>
        <translation>Über Ellipsoid [{0}]</translation>
    </message>
    <message>
        <source>Place on the path of its sortie: 0 is take-off, leg 5 ends at 5</source>
        <translation>Platz auf dem Flugweg des Einsatzes: 0 ist der Start, Strecke 5 endet bei 5</translation>
    </message>
    <message>
        <source>Clockwise from true north</source>
        <translation>Im Uhrzeigersinn ab geografisch Nord</translation>
    </message>
    <message>
        <source>0 level, -90 straight down</source>
        <translation>0 waagerecht, -90 senkrecht nach unten</translation>
    </message>
    <message>
        <source>Length of the leg that ends here</source>
        <translation>Länge der Strecke, die hier endet</translation>
    </message>
    <message>
        <source>Minutes and seconds after lift-off, with a stop at every waypoint</source>
        <translation>Minuten und Sekunden nach dem Abheben, mit Halt an jedem Wegpunkt</translation>
    </message>
    <message>
        <source>Panels that this photo covers; known after a check</source>
        <translation>Scheiben, die dieses Foto abdeckt; bekannt nach einer Prüfung</translation>
    </message>
</context>
<context>
    <name>WaypointTable</name>
    <message>
        <source>Photos only</source>
        <translation>Nur Fotos</translation>
    </message>
    <message>
        <source>Leave out where the path only turns</source>
        <translation>Knicke im Flugweg ohne Foto auslassen</translation>
    </message>
    <message>
        <source>All sorties</source>
        <translation>Alle Einsätze</translation>
    </message>
    <message>
        <source>Sortie {0}</source>
        <translation>Einsatz {0}</translation>
    </message>
    <message>
        <source>In no sortie</source>
        <translation>In keinem Einsatz</translation>
    </message>
    <message>
        <source>Frame of the positions; east and north count from the site&apos;s origin</source>
        <translation>Bezug der Positionen; Ost und Nord zählen vom Nullpunkt des Standorts</translation>
    </message>
    <message>
        <source>What heights are counted from; heights above take-off are always shown, too</source>
        <translation>Wovon Höhen zählen; Höhen über Start stehen immer dabei</translation>
    </message>
    <message>
        <source>East, north</source>
        <translation>Ost, Nord</translation>
    </message>
    <message>
        <source>Lat, lon (WGS 84)</source>
        <translation>Grad (WGS 84)</translation>
    </message>
    <message>
        <source>Heights: local</source>
        <translation>Höhen: lokal</translation>
    </message>
    <message>
        <source>Heights: sea level (EGM96)</source>
        <translation>Höhen: Meer (EGM96)</translation>
    </message>
    <message>
        <source>Heights: ellipsoid (WGS 84)</source>
        <translation>Höhen: Ellipsoid</translation>
    </message>
    <message>
        <source>Waypoints</source>
        <translation>Wegpunkte</translation>
    </message>
</context>
<context>
    <name>Workspace</name>
    <message>
        <source>{0}: cancelled</source>
        <translation>{0}: abgebrochen</translation>
    </message>
    <message>
        <source>{0}: {1}</source>
        <translation>{0}: {1}</translation>
    </message>
    <message>
        <source>{0}: Reflight failed where it should not ({1}: {2}); please report it</source>
        <translation>{0}: Reflight versagte, wo es nicht darf ({1}: {2}); bitte melden</translation>
    </message>
</context>
<context>
    <name>_EffectCard</name>
    <message>
        <source>auto</source>
        <translation>auto</translation>
    </message>
    <message>
        <source>on</source>
        <translation>an</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>is on</source>
        <translation>ist an</translation>
    </message>
    <message>
        <source>is off</source>
        <translation>ist aus</translation>
    </message>
    <message>
        <source> (as you asked)</source>
        <translation> (wie verlangt)</translation>
    </message>
    <message>
        <source>Size {0:.3g} {1}, tolerance {2:.3g}; costs about {3:.1f} s</source>
        <translation>Größe {0:.3g} {1}, Toleranz {2:.3g}; kostet etwa {3:.1f} s</translation>
    </message>
</context>
</TS>
